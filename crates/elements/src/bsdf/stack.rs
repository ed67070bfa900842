//! A BSDF at a point: a few weighted lobes, each in its shading frame.

use aureole_math::{Frame, Point2, Vector3};
use aureole_spectrum::Spectrum;

use super::{DiffuseLobe, Interior, Lobe, LobeFlags, LobeOps, TransportMode};

/// A lobe with its share of the whole and its place.
#[derive(Clone, Debug)]
struct Placed {
    lobe: Lobe,
    weight: f32,
    frame: Frame,
    /// The shading normal before bump or normal mapping: both normals must agree about sides, or light would leak.
    base_normal: Vector3,
    /// Squared roughness of the facets that a bent normal stands for; zero where nothing is softened.
    bump_alpha2: f32,
    /// What light meets that goes through it: a place in the list of interiors.
    interior: Option<u32>,
    /// Whether its Dirac counts as a density of one beside the other lobes of a blend.
    counts_dirac: bool,
}

/// The scattering at a point of a surface, in world space. The weights of its lobes sum to at most one. How many there are
/// is bounded by what a scene's compiler lets materials refer to; who uses a BSDF again spares its memory.
#[derive(Clone, Debug, Default)]
pub struct Bsdf {
    lobes: Vec<Placed>,
    interiors: Vec<Interior>,
}

/// A direction drawn from a BSDF.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsdfSample {
    /// Unit direction in the world.
    pub wi: Vector3,
    /// Value times |cos θi| over density: what a path's throughput is multiplied by.
    pub weight: Spectrum,
    /// Density per steradian; meaningless for delta samples.
    pub pdf_omega: f32,
    /// The kind of scattering.
    pub flags: LobeFlags,
    /// Relative index of refraction along the path.
    pub eta: f32,
    /// The interior behind the lobe, if the direction goes through it: see [`Bsdf::interior`].
    pub interior: Option<u32>,
}

impl BsdfSample {
    /// Whether the direction goes straight through, as if there were no surface.
    #[inline]
    pub fn is_straight(&self) -> bool {
        self.flags.delta && self.flags.transmission && self.eta == 1.0
    }
}

impl Placed {
    /// Both directions in the lobe's frame, unless a bent normal puts `wi` on the wrong side.
    #[inline]
    fn local(&self, wo: Vector3, wi: Vector3) -> Option<[Vector3; 2]> {
        let bent = [self.frame.to_local(wo), self.frame.to_local(wi)];
        let agrees = |v: Vector3, local: Vector3| v.dot(self.base_normal) * local.z > 0.0;
        (agrees(wi, bent[1]) && agrees(wo, bent[0])).then_some(bent)
    }

    #[inline]
    fn eval_cos(&self, wo: Vector3, wi: Vector3, mode: TransportMode) -> Spectrum {
        match self.local(wo, wi) {
            Some([wo, local_wi]) => {
                self.lobe.eval(wo, local_wi, mode) * (local_wi.z.abs() * self.weight * self.shadowing(wi))
            }
            None => Spectrum::ZERO,
        }
    }

    /// How much of the light from `wi` reaches a surface whose normal is bent: it fades towards the horizon of the true
    /// surface, where a bent normal alone would cut it off.
    ///
    /// # References
    /// [Conty Estevez, Lecocq and Stein 2019] "A Microfacet-Based Shadowing Function to Solve the Bump Terminator
    /// Problem", Ray Tracing Gems.
    #[inline]
    fn shadowing(&self, wi: Vector3) -> f32 {
        if self.bump_alpha2 == 0.0 {
            return 1.0;
        }
        let cos2 = wi.dot(self.base_normal).powi(2).max(1e-12);
        2.0 / (1.0 + (1.0 + self.bump_alpha2 * (1.0 - cos2) / cos2).sqrt())
    }

    #[inline]
    fn pdf_omega(&self, wo: Vector3, wi: Vector3) -> f32 {
        self.local(wo, wi).map_or(0.0, |[wo, wi]| self.lobe.pdf_omega(wo, wi))
    }
}

impl Bsdf {
    /// A BSDF without lobes: it absorbs everything.
    #[inline]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a lobe in a frame; `base_normal` is the shading normal before it was bent.
    #[inline]
    pub fn push(&mut self, lobe: impl Into<Lobe>, weight: f32, frame: Frame, base_normal: Vector3) {
        if weight > 0.0 {
            let lobe = lobe.into();
            self.lobes.push(Placed {
                lobe,
                weight,
                frame,
                base_normal,
                bump_alpha2: 0.0,
                interior: None,
                counts_dirac: false,
            });
        }
    }

    /// Adds a lobe that is the boundary of a body filled by `interior`.
    #[inline]
    pub fn push_boundary(
        &mut self,
        lobe: impl Into<Lobe>,
        interior: Interior,
        weight: f32,
        frame: Frame,
        base_normal: Vector3,
    ) {
        let before = self.lobes.len();
        self.push(lobe, weight, frame, base_normal);
        if self.lobes.len() > before {
            self.lobes[before].interior = Some(self.interiors.len() as u32);
            self.interiors.push(interior);
        }
    }

    /// Whether some lobe is the boundary of a filled body.
    #[inline]
    pub fn has_interior(&self) -> bool {
        !self.interiors.is_empty()
    }

    /// The interior that a sample names.
    #[inline]
    pub fn interior(&self, index: u32) -> Interior {
        self.interiors[index as usize]
    }

    /// Lets the sides of all lobes from the `first` on be judged by the normal before it was bent, and their terminator
    /// be softened where that is wanted.
    pub(super) fn rebase(&mut self, first: usize, normal: Vector3, soften: bool) {
        for placed in &mut self.lobes[first..] {
            // A two-sided material below may have turned its frame round; the base normal turns with it.
            placed.base_normal = normal.face_forward(placed.frame.n);
            if soften {
                let cos2 = normal.dot(placed.frame.n).powi(2).max(1e-12);
                placed.bump_alpha2 = (0.125 * (1.0 - cos2) / cos2).clamp(0.0, 1.0);
            }
        }
    }

    /// Lets the Diracs of all lobes from the `first` on count as densities of one: see `blend`.
    pub(super) fn count_diracs(&mut self, first: usize) {
        for placed in &mut self.lobes[first..] {
            placed.counts_dirac = true;
        }
    }

    /// The value over the density of a Dirac sample that counts as a density, beside the other lobes of its blend.
    fn with_dirac(
        &self,
        chosen: &Placed,
        [wo, wi]: [Vector3; 2],
        own_value: Spectrum,
        own_density: f32,
        mode: TransportMode,
    ) -> Spectrum {
        let (mut value, mut density) = (own_value, chosen.weight * own_density);
        for other in self.lobes.iter().filter(|other| other.counts_dirac && !std::ptr::eq(*other, chosen)) {
            value += other.eval_cos(wo, wi, mode);
            density += other.weight * other.pdf_omega(wo, wi);
        }
        value / density
    }

    /// The names of all lobes, for people who look into a path.
    pub fn lobe_names(&self) -> Vec<&'static str> {
        self.lobes.iter().map(|placed| placed.lobe.name()).collect()
    }

    /// How many lobes there are.
    pub(super) fn len(&self) -> usize {
        self.lobes.len()
    }

    /// Takes all lobes away, to be used again.
    #[inline]
    pub fn clear(&mut self) {
        self.lobes.clear();
        self.interiors.clear();
    }

    /// Whether [`sample`](Self::sample) looks at `uc`.
    #[inline]
    pub fn has_choice(&self) -> bool {
        match self.lobes.as_slice() {
            [only] => only.lobe.has_choice(),
            _ => true,
        }
    }

    /// Whether light sampling can contribute: some lobe is not a Dirac.
    #[inline]
    pub fn is_smooth(&self) -> bool {
        self.lobes.iter().any(|placed| !placed.lobe.is_delta())
    }

    /// How much light goes straight on, as if there were no surface.
    pub fn null_transmittance(&self) -> Spectrum {
        let share = |placed: &Placed| match &placed.lobe {
            Lobe::Null(lobe) => lobe.transmittance * placed.weight,
            _ => Spectrum::ZERO,
        };
        self.lobes.iter().map(share).sum()
    }

    /// Roughens mirrors and windows, and what is nearly so: see `Lobe::regularized`.
    pub fn regularize(&mut self) {
        for placed in &mut self.lobes {
            placed.lobe = placed.lobe.regularized();
        }
    }

    /// Turns each lobe into a matte one that scatters as much of the light to `wo`, estimated with these numbers. What is not
    /// there stays so.
    pub fn make_diffuse(&mut self, wo: Vector3, uc: f32, u: Point2) {
        for placed in &mut self.lobes {
            let local = placed.frame.to_local(wo);
            if matches!(placed.lobe, Lobe::Null(_)) {
                continue;
            }
            let drawn = placed.lobe.sample(local, uc, u, TransportMode::Radiance);
            let reflectance = drawn.map_or(Spectrum::ZERO, |d| d.value * (d.wi.z.abs() / d.pdf_omega));
            placed.lobe = DiffuseLobe { reflectance }.into();
            placed.interior = None;
            if local.z < 0.0 {
                (placed.frame, placed.base_normal) = (placed.frame.flipped(), -placed.base_normal);
            }
        }
        self.interiors.clear();
    }

    /// Whether values and densities are estimates by a random walk.
    pub fn is_estimate(&self) -> bool {
        self.lobes.iter().any(|placed| placed.lobe.is_estimate())
    }

    /// Value times |cos θi|.
    #[inline]
    pub fn eval_cos(&self, wo: Vector3, wi: Vector3, mode: TransportMode) -> Spectrum {
        match self.lobes.as_slice() {
            [only] => only.eval_cos(wo, wi, mode),
            lobes => lobes.iter().map(|placed| placed.eval_cos(wo, wi, mode)).sum(),
        }
    }

    /// Density of [`sample`](Self::sample) per steradian.
    #[inline]
    pub fn pdf_omega(&self, wo: Vector3, wi: Vector3) -> f32 {
        match self.lobes.as_slice() {
            [] => 0.0,
            [only] => only.pdf_omega(wo, wi),
            lobes => {
                let total: f32 = lobes.iter().map(|placed| placed.weight).sum();
                lobes.iter().map(|placed| placed.weight * placed.pdf_omega(wo, wi)).sum::<f32>() / total
            }
        }
    }

    /// Draws a direction: first a lobe by weight (with `uc`), then a direction from it.
    #[inline]
    pub fn sample(&self, wo: Vector3, uc: f32, u: Point2, mode: TransportMode) -> Option<BsdfSample> {
        let total: f32 = self.lobes.iter().map(|placed| placed.weight).sum();
        let (chosen, uc) = self.choose(uc, total)?;
        let local_wo = chosen.frame.to_local(wo);
        let drawn = chosen.lobe.sample(local_wo, uc, u, mode)?;
        let wi = chosen.frame.to_world(drawn.wi);
        if wi.dot(chosen.base_normal) * drawn.wi.z <= 0.0 || wo.dot(chosen.base_normal) * local_wo.z <= 0.0 {
            return None;
        }
        let probability = chosen.weight / total;
        let own_pdf = drawn.pdf_omega * probability;
        let own_value = || drawn.value * (drawn.wi.z.abs() * chosen.weight * chosen.shadowing(wi));
        let (weight, pdf_omega) = if drawn.flags.delta && chosen.counts_dirac {
            (self.with_dirac(chosen, [wo, wi], own_value(), drawn.pdf_omega, mode) * total, own_pdf)
        } else if drawn.flags.delta || self.lobes.len() == 1 {
            (own_value() / own_pdf, own_pdf)
        } else if self.is_estimate() {
            // Only the lobe's own value over its own density is right on average; the sum of densities still serves to
            // weigh this sample against those of lights.
            (own_value() / own_pdf, self.pdf_omega(wo, wi))
        } else {
            let pdf_omega = self.pdf_omega(wo, wi);
            (self.eval_cos(wo, wi, mode) / pdf_omega, pdf_omega)
        };
        let usable = pdf_omega > 0.0 && weight.is_finite() && !weight.is_black();
        let interior = if drawn.flags.transmission { chosen.interior } else { None };
        usable.then_some(BsdfSample { wi, weight, pdf_omega, flags: drawn.flags, eta: drawn.eta, interior })
    }

    /// The lobe at `uc`, and `uc` stretched to be used again.
    #[inline]
    fn choose(&self, uc: f32, total: f32) -> Option<(&Placed, f32)> {
        if let [only] = self.lobes.as_slice() {
            return Some((only, uc));
        }
        let mut rest = uc * total;
        let last = self.lobes.last()?;
        for placed in &self.lobes {
            if rest < placed.weight {
                return Some((placed, (rest / placed.weight).min(1.0 - f32::EPSILON)));
            }
            rest -= placed.weight;
        }
        Some((last, 1.0 - f32::EPSILON))
    }

    /// An estimate of how much light is scattered, for albedo images.
    pub fn albedo(&self, wo: Vector3) -> Spectrum {
        self.lobes.iter().map(|placed| placed.lobe.albedo(placed.frame.to_local(wo)) * placed.weight).sum()
    }
}
