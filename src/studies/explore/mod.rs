//! What to touch next: the places that tell most about S and R.
//!
//! ```text
//! fit -> P = (E'E)^-1, g = d(mean S, mean R)/dc
//! a touch adds three rows A: u^2 = g' P g falls by (A P g)' (I + A P A')^-1 (A P g)        planner.rs, covariance.rs
//! the same with draws of the recognition in place of P and g                                predictive_planner.rs
//! loop: sweep -> recognise -> plan -> touch, until the goal or the budget                   exploration.rs
//! ```
//!
//! A robot that has its own world fits its contacts and asks a [`TouchPlanner`], once or again and again.
//! `palpate explore` plays the whole loop in a simulated world. There S, R and their intervals come from
//! [`recognition`](palpate_inference::recognition), whose uncertainty counts doubt about the kind of surface, and so does the choice of
//! touches.
//!
//! ```
//! # use palpate_studies::facade as palpate;
//! use palpate::explore::TouchPlanner;
//! use palpate::fit::{NormalSigma, Objective};
//! use palpate::{Contacts, FitOptions, fit_contacts};
//!
//! // a dish touched at nine places with normals
//! let (x, y): (Vec<f64>, Vec<f64>) = (0..9).map(|r| (f64::from(r % 3 - 1), f64::from(r / 3 - 1))).unzip();
//! let z = x.iter().zip(&y).map(|(x, y)| 0.1 * (x * x + y * y)).collect();
//! let [nx, ny] = [&x, &y].map(|v| v.iter().map(|v| -0.2 * v).collect());
//! let contacts = Contacts::from_positions(x, y, z).with_normals(nx, ny, vec![1.0; 9]);
//! let noise = Objective::Normals(NormalSigma::Known { z: 0.01, normal_deg: 1.0 });
//! let fit = fit_contacts(&contacts, &FitOptions::default().with_objective(noise))?;
//! let mut planner = TouchPlanner::new(&fit)?;
//! assert_eq!(planner.next_touches(&[[0.0, 0.5], [1.0, 0.9], [0.1, 0.0]], 2)?.len(), 2);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod acquisition;
mod answer;
mod covariance;
mod curvature_departure_test;
mod error;
mod exploration;
mod model;
mod planner;
mod predictive_planner;
mod richer_spline_test;
mod rows;
mod simulated_sensor;
mod status;
mod stopping;
mod strategy;

pub use error::ExploreError;
#[doc(hidden)]
pub use exploration::{Exploration, ExploreOptions, explore};
pub use model::planning_fit;
pub use planner::TouchPlanner;
#[doc(hidden)]
pub use predictive_planner::best_of_map;
#[doc(hidden)]
pub use simulated_sensor::Hand;
#[doc(hidden)]
pub use status::{Look, Stopped};
#[doc(hidden)]
pub use stopping::Goal;
#[doc(hidden)]
pub use strategy::Strategy;
