//! What the four lanes of a spectrum stand for.

use glam::Vec4;

/// How colour is carried through a render.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ColorMode {
    /// Linear Rec. 709 with a D65 white.
    #[default]
    Rgb,
    /// Four hero wavelengths a path.
    Spectral,
}

/// The wavelengths of a path's four lanes, in nanometres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wavelengths {
    lambda: Vec4,
}

impl Wavelengths {
    /// RGB mode: lanes are R, G, B and a spare.
    pub const RGB: Self = Self { lambda: Vec4::ZERO };

    /// Which mode these lanes belong to.
    #[inline]
    pub fn mode(&self) -> ColorMode {
        if self.lambda == Vec4::ZERO { ColorMode::Rgb } else { ColorMode::Spectral }
    }
}
