//! Convex hull of points in the plane.

/// Convex hull, anticlockwise, as indices: A. M. Andrew's monotone chain, *Inf. Process. Lett.* 9 (1979) 216.
pub(super) fn hull(points: &[[f64; 2]]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|a, b| points[*a][0].total_cmp(&points[*b][0]).then(points[*a][1].total_cmp(&points[*b][1])));
    let mut chain: Vec<usize> = Vec::new();
    for pass in 0..2 {
        let floor = chain.len() + usize::from(pass == 0);
        for &k in &order {
            while chain.len() > floor && twice_area(points, chain[chain.len() - 2], chain[chain.len() - 1], k) <= 0.0 {
                chain.pop();
            }
            chain.push(k);
        }
        chain.pop();
        order.reverse();
    }
    chain
}

/// Twice the area of a triangle, positive when anticlockwise.
fn twice_area(p: &[[f64; 2]], a: usize, b: usize, c: usize) -> f64 {
    (p[b][0] - p[a][0]) * (p[c][1] - p[a][1]) - (p[b][1] - p[a][1]) * (p[c][0] - p[a][0])
}
