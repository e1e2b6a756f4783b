//! Every candidate touched once, for a peer that chooses among them: `benches/peers/explore_gp.py` reads it.
//!
//! ```text
//! object,noise,S,R        then 441 lines x,y,z,nx,ny,nz       S, R: true means over 8 x 8 points of the patch
//! ```

use palpate::Orientation;
use palpate::scene::{Sweep, World};
use palpate_world::scene::linspace;

use crate::objects::{HALF, object};

pub(crate) fn print(first: u64, objects: u64, noises: u64) {
    for seed in first..first + objects {
        for noise in 1..=noises {
            one(seed, noise);
        }
    }
}

fn one(seed: u64, noise: u64) {
    let axis = linspace(-HALF, HALF, 21);
    let world = World { sweeps: vec![Sweep::new(axis.clone(), axis)], ..object(seed) };
    let simulator = world.compile().expect("the objects lie under the whole patch");
    // draws that no exploration of this object has: another replicate
    let (contacts, truth) = simulator.simulate(noise, 1);
    let grid = linspace(-HALF, HALF, 8);
    let (mut s, mut r, mut defined) = (0.0, 0.0, 0.0);
    for (x, y) in grid.iter().flat_map(|x| grid.iter().map(move |y| (*x, *y))) {
        let Some(here) = truth.at(x, y) else { continue };
        r += here.local.curvedness() / 64.0;
        if let Some(index) = here.local.shape_index() {
            s += index;
            defined += 1.0;
        }
    }
    println!("{seed},{noise},{},{r}", s / defined);
    let Orientation::Normals { nx, ny, nz } = &contacts.orientation else { return };
    for k in 0..contacts.len() {
        let (x, y, z) = (contacts.x[k], contacts.y[k], contacts.z[k]);
        println!("{x},{y},{z},{},{},{}", nx[k], ny[k], nz[k]);
    }
}
