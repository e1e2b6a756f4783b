// CGAL beside palpate parts: Efficient RANSAC on points with normals, or jets on points alone.
//   cgal_shapes ransac FILE NOISE SPACING     -> seconds, then a line for each shape: kind, radius, points
//   cgal_shapes jets FILE                     -> seconds, then k1 k2 of every point
// FILE holds x y z nx ny nz as doubles.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Kd_tree.h>
#include <CGAL/Monge_via_jet_fitting.h>
#include <CGAL/Orthogonal_k_neighbor_search.h>
#include <CGAL/Point_with_normal_3.h>
#include <CGAL/Search_traits_3.h>
#include <CGAL/Shape_detection/Efficient_RANSAC.h>
#include <CGAL/property_map.h>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

typedef CGAL::Exact_predicates_inexact_constructions_kernel Kernel;
typedef std::pair<Kernel::Point_3, Kernel::Vector_3> Placed;
typedef std::vector<Placed> Points;
typedef CGAL::First_of_pair_property_map<Placed> Place;
typedef CGAL::Second_of_pair_property_map<Placed> Normal;
typedef CGAL::Shape_detection::Efficient_RANSAC_traits<Kernel, Points, Place, Normal> Traits;
typedef CGAL::Shape_detection::Efficient_RANSAC<Traits> Ransac;

static Points read(const char *name) {
    Points points;
    FILE *file = std::fopen(name, "rb");
    double v[6];
    while (std::fread(v, 8, 6, file) == 6)
        points.push_back({Kernel::Point_3(v[0], v[1], v[2]), Kernel::Vector_3(v[3], v[4], v[5])});
    std::fclose(file);
    return points;
}

static double since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

static void ransac(Points &points, double noise, double spacing) {
    auto start = std::chrono::steady_clock::now();
    Ransac search;
    search.set_input(points);
    search.add_shape_factory<CGAL::Shape_detection::Plane<Traits>>();
    search.add_shape_factory<CGAL::Shape_detection::Sphere<Traits>>();
    search.add_shape_factory<CGAL::Shape_detection::Cylinder<Traits>>();
    Ransac::Parameters parameters;
    parameters.probability = 0.01;
    parameters.min_points = points.size() / 50;
    parameters.epsilon = 3 * noise;
    parameters.cluster_epsilon = 4 * spacing;
    parameters.normal_threshold = 0.9;
    search.detect(parameters);
    std::printf("%.6f\n", since(start));
    for (auto shape : search.shapes()) {
        size_t count = shape->indices_of_assigned_points().size();
        if (auto *s = dynamic_cast<CGAL::Shape_detection::Sphere<Traits> *>(shape.get()))
            std::printf("sphere %.9g %zu\n", double(s->radius()), count);
        else if (auto *c = dynamic_cast<CGAL::Shape_detection::Cylinder<Traits> *>(shape.get()))
            std::printf("cylinder %.9g %zu\n", double(c->radius()), count);
        else
            std::printf("plane 0 %zu\n", count);
    }
}

static void jets(const Points &points) {
    typedef CGAL::Search_traits_3<Kernel> Tree_traits;
    typedef CGAL::Orthogonal_k_neighbor_search<Tree_traits> Search;
    auto start = std::chrono::steady_clock::now();
    std::vector<Kernel::Point_3> places;
    for (const auto &p : points) places.push_back(p.first);
    Search::Tree tree(places.begin(), places.end());
    std::vector<double> found;
    for (const auto &p : places) {
        Search search(tree, p, 25);
        std::vector<Kernel::Point_3> near;
        for (const auto &one : search) near.push_back(one.first);
        CGAL::Monge_via_jet_fitting<Kernel> fit;
        auto form = fit(near.begin(), near.end(), 2, 2);
        found.push_back(form.principal_curvatures(0));
        found.push_back(form.principal_curvatures(1));
    }
    std::printf("%.6f\n", since(start));
    for (size_t i = 0; i < found.size(); i += 2) std::printf("%.9g %.9g\n", found[i], found[i + 1]);
}

int main(int count, char **words) {
    if (count < 3) return 2;
    Points points = read(words[2]);
    if (!std::strcmp(words[1], "ransac") && count == 5)
        ransac(points, std::atof(words[3]), std::atof(words[4]));
    else
        jets(points);
    return 0;
}
