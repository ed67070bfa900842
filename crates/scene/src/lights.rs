//! Choosing among lights.

use aureole_elements::Light;
use aureole_math::{Discrete, Id};

/// Chooses a light: half of the time by power, half of the time any, so that a weak light nearby is not forgotten.
#[derive(Clone, Debug, Default)]
pub struct LightPicker {
    distribution: Option<Discrete>,
}

/// A light and the probability of choosing it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightChoice {
    /// The light.
    pub light: Id<Light>,
    /// Its probability.
    pub pmf: f32,
}

impl LightPicker {
    /// A picker over lights of given power, in the order of their ids.
    pub fn new(powers: &[f32]) -> Self {
        let usable = |p: &f32| if p.is_finite() { p.max(0.0) } else { 0.0 };
        let total: f32 = powers.iter().map(usable).sum();
        let n = powers.len() as f32;
        let weight = |p: &f32| if total > 0.0 { 0.5 * usable(p) / total + 0.5 / n } else { 1.0 };
        Self { distribution: Discrete::new(powers.iter().map(weight)) }
    }

    /// Whether there is more than one light to choose from.
    #[inline]
    pub fn has_choice(&self) -> bool {
        self.distribution.as_ref().is_some_and(|d| d.len() > 1)
    }

    /// A light; `None` in a scene without any.
    #[inline]
    pub fn pick(&self, u: f32) -> Option<LightChoice> {
        let drawn = self.distribution.as_ref()?.sample(u);
        Some(LightChoice { light: Id::new(drawn.index as u32), pmf: drawn.pmf })
    }

    /// The probability of choosing a light.
    #[inline]
    pub fn pmf(&self, light: Id<Light>) -> f32 {
        self.distribution.as_ref().map_or(0.0, |d| d.pmf(light.index()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strong_lights_are_chosen_more_often_but_weak_ones_too() {
        let picker = LightPicker::new(&[3.0, 1.0, 0.0, f32::NAN]);
        let pmf = |i| picker.pmf(Id::new(i));
        assert!(
            (pmf(0) - 0.5).abs() < 1e-6 && (pmf(2) - 0.125).abs() < 1e-6 && (pmf(3) - 0.125).abs() < 1e-6
        );
        assert!(LightPicker::new(&[]).pick(0.5).is_none());
    }
}
