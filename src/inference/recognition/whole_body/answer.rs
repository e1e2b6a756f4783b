//! The posterior of a body as a recognition: every number is read from the same weighted draws.

use palpate_geometry::contact::Frame;
use palpate_geometry::curvature::ShapeClass;
use palpate_geometry::neighbours::mean_of;
use palpate_numeric::vector::{Vector, cross, dot, reject, unit_or_zero};

use super::drawn_map::DrawnMap;
use super::drawn_shapes::{classes, free_form, mean_curvatures, variation};
use super::exchanged_axes::agreeing_order;
use super::kept_draws::{is_flat, kept_draws};
use super::own_axis::{DrawnPrimitive, axis_of};
use super::predicted_touches::predicted_over;
use crate::bodies::{
    BodyChart, BodyHypothesis, BodyPosterior, BodySample, DrawnBase, PosteriorSpread, Symmetry, drawn, is_simple,
    spread,
};
use crate::primitives::placed::{PartKind, Primitive};
use crate::recognition::contacts::Observations;
use crate::recognition::{
    Estimate, Hypothesis, Misfit, NoiseFound, NormalsUse, RecognisedSurface, Recognition, RecognitionError,
    RecognitionOptions, Remark, Tried,
};

/// What is asked about contacts.
#[derive(Clone, Copy)]
pub(super) struct BodyQuestion<'a> {
    pub(super) sample: &'a BodySample,
    pub(super) given: &'a Observations,
    pub(super) options: &'a RecognitionOptions,
    /// Places of the input's x and y at which touches are predicted.
    pub(super) touches: &'a [[f64; 2]],
}

impl<'a> BodyQuestion<'a> {
    /// With a posterior that answers it.
    pub(super) fn of<'b>(self, posterior: &'b BodyPosterior) -> BodyAnswer<'b>
    where
        'a: 'b,
    {
        let BodyQuestion { sample, given, options, touches } = self;
        BodyAnswer { posterior, sample, given, options, touches }
    }
}

/// A posterior with what it was asked about.
#[derive(Clone, Copy)]
pub(super) struct BodyAnswer<'a> {
    pub(super) posterior: &'a BodyPosterior,
    pub(super) sample: &'a BodySample,
    pub(super) given: &'a Observations,
    pub(super) options: &'a RecognitionOptions,
    /// Places of the input's x and y at which touches are predicted.
    pub(super) touches: &'a [[f64; 2]],
}

/// Which side is free: outside 1, inside -1.
struct FreeSide {
    side: f64,
    known: bool,
}

impl BodyAnswer<'_> {
    fn kind(&self) -> PartKind {
        self.posterior.kind()
    }

    /// Whether it is a free surface that contacts go all round.
    pub(super) fn closes(&self) -> bool {
        self.posterior.closes(self.sample, &self.options.tuning)
    }

    /// Whether it is a free surface that bends as broadly as a body does, about which normals scatter as a sensor's do: dimples, waves and errors
    /// of a sensor are shorter, and of errors that places share normals know nothing. It follows each contact: a field follows very many better.
    pub(super) fn bends_as_a_body(&self) -> bool {
        let tuning = &self.options.tuning;
        let Some(best) = self.posterior.best_of(self.kind()) else { return false };
        let is_broad = best.length().is_some_and(|length| length >= tuning.shape_from);
        let follows_each = self.sample.len() <= tuning.free_contacts;
        follows_each && is_broad && (self.sample.known_normals() == 0 || best.is_of_a_sensor(tuning))
    }

    /// Share of the contacts that are none of the body's.
    pub(super) fn false_share(&self) -> f64 {
        1.0 - self.posterior.members_of(self.kind()).len() as f64 / self.sample.len() as f64
    }

    /// Share of the normals that stand more than 60 degrees off the surface of a patch's middle: a body has them all.
    pub(super) fn normals_against(&self) -> f64 {
        let known: Vec<Vector> = (0..self.sample.len()).filter_map(|i| self.sample.normal(i)).collect();
        let middle = unit_or_zero(mean_of(&known));
        let against = known.iter().filter(|n| dot(**n, middle) < 0.5).count();
        against as f64 / known.len().max(1) as f64
    }

    /// Probability of the likeliest kind.
    pub(super) fn probability(&self) -> f64 {
        self.posterior.weight_of(self.kind())
    }

    /// Whether it is a plane, a ball, a bar or a cone for all that it departs: a stem is a bar though its section is not quite round.
    /// Rings and ellipsoids follow any smooth surface, and are not asked.
    pub(super) fn is_of_simple_kind(&self) -> bool {
        let kind = self.kind();
        let draws = drawn(self.posterior, &self.options.tuning, self.options.seed);
        is_simple(kind) && !self.is_free_form(self.free_form(&draws), &draws)
    }

    /// Whether draws of another shape are most of those of its kind.
    fn is_free_form(&self, free: f64, draws: &[DrawnBase]) -> bool {
        let of_kind: f64 = draws.iter().filter(|d| d.primitive.kind == self.kind()).map(|d| d.share).sum();
        free > 0.5 * of_kind
    }

    /// Share of the draws whose departure makes another shape of them.
    fn free_form(&self, draws: &[DrawnBase]) -> f64 {
        if self.posterior.is_free { 1.0 } else { free_form(draws, &self.members(), &self.options.tuning) }
    }

    /// Contacts that are the body's own.
    fn members(&self) -> Vec<Vector> {
        self.posterior.members_of(self.kind()).iter().map(|&i| self.sample.points[i]).collect()
    }

    /// Whether the normals, where there are any, follow the body: normals at random would follow any as badly.
    pub(super) fn explains_normals(&self) -> bool {
        self.sample.known_normals() == 0 || self.sd_of_normals() < self.options.tuning.random_normals
    }

    pub(super) fn sd_of_normals(&self) -> f64 {
        self.posterior.best_of(self.kind()).map_or(f64::INFINITY, BodyHypothesis::sd_of_normals)
    }

    /// # Errors
    /// [`RecognitionError::NormalsExchanged`].
    pub(super) fn check_axes_of_normals(&self) -> Result<(), RecognitionError> {
        let Some(likeliest) = self.posterior.likeliest(self.kind()) else { return Ok(()) };
        let pair = |i: &usize| Some((self.sample.normal(*i)?, likeliest.nearest(self.sample.points[*i]).1));
        let pairs: Vec<(Vector, Vector)> = self.posterior.members_of(self.kind()).iter().filter_map(pair).collect();
        let order = agreeing_order(&pairs, &self.options.tuning);
        order.map_or(Ok(()), |order| Err(RecognitionError::NormalsExchanged { order }))
    }

    /// The whole answer, if its axes are those of the normals.
    ///
    /// # Errors
    /// Those of [`BodyAnswer::check_axes_of_normals`] and [`BodyAnswer::recognition`].
    pub(super) fn checked(&self) -> Result<Recognition, RecognitionError> {
        self.check_axes_of_normals()?;
        self.recognition()
    }

    /// What tells the free side: a viewpoint, most of the normals, or a direction.
    fn free_side(&self, likeliest: &Primitive) -> FreeSide {
        if let Some(viewpoint) = self.options.viewpoint {
            let (distance, _) = likeliest.nearest(self.sample.frame.to_patch(viewpoint));
            return FreeSide { side: distance.signum(), known: true };
        }
        let members = &self.posterior.members_of(self.kind());
        let outwards = |i: &usize| likeliest.nearest(self.sample.points[*i]).1;
        let votes: Vec<f64> = members.iter().filter_map(|i| Some(dot(self.sample.normal(*i)?, outwards(i)))).collect();
        if !votes.is_empty() {
            let out = votes.iter().filter(|vote| **vote > 0.0).count() as f64 / votes.len() as f64;
            let side = if out >= 0.5 { 1.0 } else { -1.0 };
            return FreeSide { side, known: out.max(1.0 - out) >= self.options.tuning.normals_agree };
        }
        if let Some(up) = self.options.up {
            let sum: f64 = members.iter().map(|i| dot(outwards(i), up)).sum();
            return FreeSide { side: sum.signum(), known: true };
        }
        FreeSide { side: 1.0, known: false }
    }

    /// The whole answer.
    ///
    /// # Errors
    /// [`RecognitionError::Arithmetic`] where no draw has a shape.
    pub(super) fn recognition(&self) -> Result<Recognition, RecognitionError> {
        let kind = self.kind();
        let failed = RecognitionError::Arithmetic { step: "averaging", what: "no drawn body has a shape" };
        let likeliest = self.posterior.likeliest(kind).ok_or(failed.clone())?;
        let side = self.free_side(&likeliest);
        let turned = |primitive: Primitive| Primitive { side: side.side, ..primitive };
        let mut draws = drawn(self.posterior, &self.options.tuning, self.options.seed);
        draws.iter_mut().for_each(|d| d.primitive = turned(d.primitive));
        let members = self.members();
        let free = self.free_form(&draws);
        let is_free = self.is_free_form(free, &draws);
        let primitive = turned(likeliest);
        // a departure that is likelier shape is shown, though the kind is still that of the primitive
        let is_shape = |node: &&BodyHypothesis| is_free || node.departs_in_shape(&self.options.tuning);
        let surface = match self.posterior.best_of(kind).filter(is_shape) {
            Some(node) => DrawnBase::likeliest(primitive, node),
            None => DrawnBase::of_primitive(primitive),
        };
        let finer = if self.posterior.is_free { surface.finer_shape(&members, &self.options.tuning) } else { None };
        draws.iter_mut().zip(0..).for_each(|(d, number)| d.finer = finer.map(|finer| (finer, number)));
        let chart_surface = if self.posterior.is_free { surface.clone() } else { DrawnBase::of_primitive(primitive) };
        let chart = BodyChart::new(self.sample.frame, surface, &members, draws.clone(), &self.options.tuning);
        let DrawnMap { map, supported, shapes } = DrawnMap::over(&chart, self.options);
        let predictive = predicted_over(&chart, &shapes, self.touches, &self.given.points);
        let averaged: Vec<(Vector, Vector)> =
            map.iter().filter(|p| p.supported).map(|p| (p.position, p.normal)).collect();
        let places: Vec<Vector> = averaged.iter().map(|(p, _)| self.sample.frame.to_patch(*p)).collect();
        let plane: f64 = draws.iter().filter(|d| is_flat(d)).map(|d| d.share).sum();
        let [s_over_map, r_over_map] = variation(&map);
        let s = self.estimate(&draws, |d, i| (!is_flat(d)).then_some(shapes[i]?[0]), kind);
        let s = s.map(|s| Estimate { sd: s_over_map, ..s });
        let r = self.estimate(&draws, |_, i| Some(shapes[i]?[1]), kind).ok_or(failed)?;
        let scale = self.sample.frame.scale;
        let curvedness = Estimate { sd: r_over_map, ..r.over(scale) };
        let shape = s.filter(|_| plane <= 0.5);
        let class = shape.map_or(ShapeClass::Plane, |s| ShapeClass::of_shape_index(s.mean));
        let [k1, k2] = mean_curvatures(&chart_surface, &places).map(|k| k / scale);
        let frame = oriented(&chart, &self.sample.frame);
        let symmetry = self.posterior.symmetry();
        let of_draws = self.told_by(&primitive, &draws);
        let axis = match symmetry {
            _ if !self.posterior.is_free => axis_of(&primitive).filter(|_| class != ShapeClass::Plane),
            Symmetry::None => None,
            Symmetry::Turned | Symmetry::Extruded => Some(primitive.axes[2]),
        };
        // a cone or a ring has no one radius of the pipe or ball that its class is named after
        let is_round = matches!(likeliest.kind, PartKind::Sphere | PartKind::Cylinder);
        let has_radius = is_round && !is_free && class != ShapeClass::Plane;
        let radius = has_radius.then(|| of_draws.length(0));
        let finer_shape = finer.map(|f| Remark::FinerShape { size: [f.height, f.length].map(|v| v * scale) });
        let open_side = (!side.known).then_some(Remark::FreeSideAssumed);
        let sizes = if is_free { None } else { of_draws.sizes() };
        let found = Recognition {
            hypothesis: if is_free { Hypothesis::from(symmetry) } else { Hypothesis::from(likeliest.kind) },
            class,
            class_probability: classes(&draws, &shapes),
            shape_index: shape,
            curvedness,
            k1,
            k2,
            radius: radius.map(|[value, ..]| value),
            radii: None,
            radius_interval: radius.map(|[_, lo, hi]| [lo, hi]),
            direction: None,
            axis,
            axis_within_deg: axis.map(|axis| of_draws.axis_within(axis)),
            plane_probability: plane,
            frame,
            support: (supported, map.len()),
            map,
            grid: self.options.grid,
            over: None,
            averaged,
            surface: RecognisedSurface::of_body(frame, chart),
            outliers: self.sample.len() - members.len(),
            missing: self.given.missing,
            normals_of_length_zero: self
                .given
                .normals
                .as_ref()
                .map_or(0, |_| self.sample.len() - self.sample.known_normals()),
            normals_against: 0,
            normals_flipped: 0,
            normals: match (&self.given.normals, self.given.ignored) {
                (Some(_), _) => NormalsUse::Believed,
                (None, true) => NormalsUse::Ignored,
                (None, false) => NormalsUse::Absent,
            },
            noise: self.noise(kind),
            tried: if self.posterior.is_free { self.tried_free([k1, k2]) } else { self.tried(&places, free) },
            misfit: self.misfit(kind),
            effective_contacts: members.len() as f64,
            contacts: members.len(),
            notes: open_side.into_iter().chain(sizes).chain(finer_shape).collect(),
            side_known: side.known,
            predictive,
            draws: kept_draws(&draws, &shapes, &primitive, scale).into(),
        };
        Ok(if side.known { found } else { super::of_either_side(found) })
    }

    fn estimate(
        &self,
        draws: &[DrawnBase],
        value: impl Fn(&DrawnBase, usize) -> Option<f64>,
        kind: PartKind,
    ) -> Option<Estimate> {
        let of = |own: bool| {
            let each = draws.iter().enumerate().filter(move |(_, d)| !own || d.primitive.kind == kind);
            each.filter_map(|(i, d)| Some((value(d, i)?, d.share))).collect::<Vec<(f64, f64)>>()
        };
        let all = spread(&of(false), self.options.level)?;
        // new noise of the same kind of body moves the answer by what one kind's draws scatter
        let u_noise = spread(&of(true), self.options.level).map_or(0.0, |own: PosteriorSpread| own.sd.min(all.sd));
        let freedom = self.posterior.best_of(kind).map_or(1.0, |node| node.freedom());
        Some(Estimate {
            mean: all.mean,
            sd: 0.0,
            u_noise,
            u_model: (all.sd * all.sd - u_noise * u_noise).max(0.0).sqrt(),
            u: all.sd,
            interval: all.interval,
            level: self.options.level,
            dof: freedom,
        })
    }

    /// The likeliest primitive with the draws that tell its sizes.
    pub(super) fn told_by<'b>(&self, likeliest: &'b Primitive, draws: &'b [DrawnBase]) -> DrawnPrimitive<'b> {
        let (level, scale) = (self.options.level, self.sample.frame.scale);
        DrawnPrimitive { likeliest, draws, level, scale, is_free: self.posterior.is_free }
    }

    fn noise(&self, kind: PartKind) -> NoiseFound {
        let scale = self.sample.frame.scale;
        let Some(best) = self.posterior.best_of(kind) else { return NoiseFound::default() };
        NoiseFound {
            sd_z: best.scatter() * scale,
            sd_correlated: if self.posterior.is_free { 0.0 } else { best.departure_size() * scale },
            correlation_length: best.length().filter(|_| !self.posterior.is_free).map(|l| l * scale),
            sd_normal_deg: (self.sample.known_normals() > 0).then(|| best.sd_of_normals().to_degrees()),
        }
    }

    /// Every kind with its probability; what departs so far that it is none of them, `free` of all, stands for itself.
    fn tried(&self, places: &[Vector], free: f64) -> Vec<Tried> {
        let scale = self.sample.frame.scale;
        let one = |kind: PartKind| {
            let primitive = self.posterior.likeliest(kind)?;
            let [k1, k2] = mean_curvatures(&DrawnBase::of_primitive(primitive), places).map(|k| k / scale);
            let members = self.posterior.members_of(kind);
            let square: f64 = members.iter().map(|&i| primitive.nearest(self.sample.points[i]).0.powi(2)).sum();
            Some(Tried {
                hypothesis: Hypothesis::from(kind),
                weight: self.posterior.weight_of(kind),
                k1,
                k2,
                rms: scale * (square / members.len().max(1) as f64).sqrt(),
            })
        };
        let mut tried: Vec<Tried> = PartKind::BODIES.into_iter().filter_map(one).collect();
        if let Some(base) = tried.iter().max_by(|a, b| a.weight.total_cmp(&b.weight)).copied().filter(|_| free > 0.0) {
            tried.iter_mut().for_each(|t| t.weight *= 1.0 - free);
            tried.push(Tried { hypothesis: Hypothesis::Displaced, weight: free, ..base });
        }
        tried.sort_by(|a, b| b.weight.total_cmp(&a.weight));
        tried
    }

    /// Every kind with its probability, and its curvatures at places of a map.
    pub(super) fn tried_at(&self, averaged: &[(Vector, Vector)]) -> Vec<Tried> {
        let places: Vec<Vector> = averaged.iter().map(|(p, _)| self.sample.frame.to_patch(*p)).collect();
        self.tried(&places, 0.0)
    }

    /// Free surfaces by their symmetry.
    fn tried_free(&self, [k1, k2]: [f64; 2]) -> Vec<Tried> {
        let scale = self.sample.frame.scale;
        let all = [Symmetry::None, Symmetry::Turned, Symmetry::Extruded].map(|symmetry| {
            let rms = self.posterior.best_of_symmetry(symmetry).map_or(f64::NAN, |best| scale * best.scatter());
            let weight = self.posterior.weight_of_symmetry(symmetry);
            Tried { hypothesis: Hypothesis::from(symmetry), weight, k1, k2, rms }
        });
        let mut tried: Vec<Tried> = all.into_iter().filter(|t| t.rms.is_finite()).collect();
        tried.sort_by(|a, b| b.weight.total_cmp(&a.weight));
        tried
    }

    fn misfit(&self, kind: PartKind) -> Misfit {
        let exact: f64 = self.posterior.weight_without_departure();
        let Some(best) = self.posterior.best_of(kind) else {
            return Misfit { neighbour_correlation: 0.0, p: 1.0, percent_of_relief: 0.0, words: String::new() };
        };
        // what a free surface follows is shape
        let (exact, departure) = if self.posterior.is_free { (1.0, 0.0) } else { (exact, best.departure_size()) };
        let total = best.scatter().hypot(departure);
        let neighbour_correlation = if total > 0.0 { (departure / total).powi(2) } else { 0.0 };
        let words = if 1.0 - exact > self.options.tuning.certain {
            format!(
                "neighbouring contacts depart together from {}, by {:.2} % of the size of what was touched",
                Hypothesis::from(kind).described(),
                100.0 * departure
            )
        } else {
            "the residuals hold no pattern".to_string()
        };
        Misfit { neighbour_correlation, p: exact, percent_of_relief: 100.0 * total, words }
    }
}

/// The frame whose third axis is the normal in the middle of the chart.
fn oriented(chart: &BodyChart, frame: &Frame) -> Frame {
    let [u, v] = [chart.u, chart.v].map(|[lo, hi]| 0.5 * (lo + hi));
    let (_, up) = chart.at(u, v);
    let across = if up[0].abs() < 0.7 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    let side = unit_or_zero(reject(across, up));
    Frame { axes: [side, cross(up, side), up], ..*frame }
}
