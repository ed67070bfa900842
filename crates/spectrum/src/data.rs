//! Measured data by name: metals, glasses, illuminants, and the CIE's tables.

use std::sync::{Arc, OnceLock};

use crate::illuminant::{illuminant, illuminant_names};
use crate::source::Tabulated;

/// A row of the CIE's tables.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CieRow {
    pub lambda: f32,
    /// Colour matching functions x̄, ȳ, z̄ (1931, two degrees).
    pub xyz: [f32; 3],
    /// Illuminant D65, relative.
    pub d65: f32,
}

/// Lines of numbers and words, without comments.
fn rows(text: &'static str) -> impl Iterator<Item = &'static str> {
    text.lines().map(|line| line.split('#').next().unwrap_or("").trim()).filter(|line| !line.is_empty())
}

fn numbers(line: &str) -> Vec<f32> {
    line.split_whitespace().filter_map(|word| word.parse().ok()).collect()
}

/// The CIE's tables, every five nanometres.
pub(crate) fn cie() -> &'static [CieRow] {
    static TABLE: OnceLock<Vec<CieRow>> = OnceLock::new();
    TABLE.get_or_init(|| {
        let row = |line| match numbers(line)[..] {
            [lambda, x, y, z, d65] => Some(CieRow { lambda, xyz: [x, y, z], d65 }),
            _ => None,
        };
        rows(include_str!("../data/cie.txt")).filter_map(row).collect()
    })
}

/// The complex index of refraction of a conductor.
#[derive(Clone, Debug)]
pub struct Metal {
    /// The name, e.g. `Au`.
    pub name: &'static str,
    /// Real part.
    pub eta: Arc<Tabulated>,
    /// Imaginary part.
    pub k: Arc<Tabulated>,
}

/// All conductors that are known by name.
pub fn metals() -> &'static [Metal] {
    static TABLE: OnceLock<Vec<Metal>> = OnceLock::new();
    TABLE.get_or_init(|| {
        let text = include_str!("../data/metals.txt");
        let mut list: Vec<(&str, [Vec<f32>; 3])> = Vec::new();
        for line in rows(text) {
            if let Some(name) = line.strip_prefix("= ") {
                list.push((name, Default::default()));
            } else if let (Some((_, columns)), Ok(row)) =
                (list.last_mut(), <[f32; 3]>::try_from(numbers(line)))
            {
                for (column, value) in columns.iter_mut().zip(row) {
                    column.push(value);
                }
            }
        }
        let table =
            |lambda: &[f32], values: Vec<f32>| Arc::new(Tabulated { lambda: lambda.to_vec(), values });
        list.into_iter()
            .map(|(name, [lambda, eta, k])| Metal { name, eta: table(&lambda, eta), k: table(&lambda, k) })
            .collect()
    })
}

/// The conductor of that name.
pub fn metal(name: &str) -> Option<&'static Metal> {
    metals().iter().find(|metal| metal.name == name)
}

/// The index of refraction of a transparent substance at 589 nm.
pub fn dielectric_ior(name: &str) -> Option<f32> {
    dielectrics().find(|(known, _)| *known == name).map(|(_, ior)| ior)
}

/// All transparent substances that are known by name, with their indices.
pub fn dielectrics() -> impl Iterator<Item = (&'static str, f32)> {
    rows(include_str!("../data/dielectrics.txt"))
        .filter_map(|line| line.split_once(' ').and_then(|(ior, name)| Some((name, ior.parse().ok()?))))
}

/// The index of refraction of an optical glass over wavelength, by Sellmeier's equation.
pub fn glass(name: &str) -> Option<Arc<Tabulated>> {
    let line = rows(include_str!("../data/glasses.txt"))
        .find(|line| line.split_whitespace().next() == Some(name))?;
    let c = numbers(line);
    let lambda: Vec<f32> = (0..=94).map(|i| 360.0 + 5.0 * i as f32).collect();
    let index = |l: &f32| {
        let l2 = (l * 1e-3).powi(2);
        (1.0 + (0..3).map(|i| c[i] * l2 / (l2 - c[i + 3])).sum::<f32>()).sqrt()
    };
    let values = lambda.iter().map(index).collect();
    (c.len() == 6).then(|| Arc::new(Tabulated { lambda, values }))
}

/// How a substance scatters and absorbs light, per millimetre, in linear Rec. 709.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scattering {
    /// The name, e.g. `Skimmilk`.
    pub name: &'static str,
    /// Reduced scattering: what scatters as much as isotropic scattering would.
    pub scattering: [f32; 3],
    /// Absorption.
    pub absorption: [f32; 3],
}

/// All substances whose scattering was measured, by the names that pbrt gives them.
pub fn scattering_substances() -> impl Iterator<Item = Scattering> {
    rows(include_str!("../data/scattering.txt")).filter_map(|line| {
        let mut rest = line;
        let mut number = || {
            let (word, after) = rest.split_once(' ')?;
            rest = after.trim_start();
            word.parse::<f32>().ok()
        };
        let mut three = || Some([number()?, number()?, number()?]);
        let (scattering, absorption) = (three()?, three()?);
        Some(Scattering { name: rest, scattering, absorption })
    })
}

/// Planck's law: radiance in W·sr⁻¹·m⁻²·nm⁻¹ of a black body.
pub fn blackbody(kelvin: f32) -> Tabulated {
    const H: f64 = 6.626_070_15e-34;
    const C: f64 = 299_792_458.0;
    const K_B: f64 = 1.380_649e-23;
    let lambda: Vec<f32> = cie().iter().map(|row| row.lambda).collect();
    let radiance = |&l: &f32| {
        let l = f64::from(l) * 1e-9;
        let x = H * C / (l * K_B * f64::from(kelvin));
        (2.0 * H * C * C / (l.powi(5) * x.exp_m1()) * 1e-9) as f32
    };
    Tabulated { values: lambda.iter().map(radiance).collect(), lambda }
}

/// A spectrum by one of pbrt's names: `metal-Au-eta`, `glass-BK7`, `stdillum-D65`, `stdillum-F2`, `illum-acesD60`.
///
/// Illuminants are relative: 100 at 560 nm, but the F series as the CIE prints it.
pub fn named_spectrum(name: &str) -> Option<Arc<Tabulated>> {
    if let Some(rest) = name.strip_prefix("metal-") {
        let (metal_name, part) = rest.rsplit_once('-')?;
        let found = metal(metal_name)?;
        return match part {
            "eta" => Some(found.eta.clone()),
            "k" => Some(found.k.clone()),
            _ => None,
        };
    }
    if let Some(rest) = name.strip_prefix("glass-") {
        return glass(rest).or_else(|| glass(&format!("S{rest}"))); // pbrt says F5, F10, F11 for SF5, SF10, SF11
    }
    illuminant(name)
}

/// The names that [`named_spectrum`] knows, for "did you mean".
pub fn spectrum_names() -> Vec<String> {
    let metals = metals().iter().flat_map(|m| ["eta", "k"].map(|part| format!("metal-{}-{part}", m.name)));
    let glasses = rows(include_str!("../data/glasses.txt"))
        .filter_map(|line| line.split_whitespace().next())
        .map(|name| format!("glass-{name}"));
    metals.chain(glasses).chain(illuminant_names().map(str::to_owned)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SpectrumRole;

    /// Values that Mitsuba 3.9 (`scalar_rgb`) derives from the same measurements.
    #[test]
    fn metals_have_their_known_rgb() {
        let near = |table: &Tabulated, rgb: [f32; 3]| {
            let found = table.to_rgb(SpectrumRole::Index);
            (0..3).all(|c| (found[c] - rgb[c]).abs() < 0.01 * rgb[c])
        };
        assert!(near(&metal("Al").unwrap().eta, [1.6575, 0.880405, 0.521244]));
        assert!(near(&metal("Au").unwrap().k, [3.983, 2.38556, 1.60336]));
        assert!(near(&metal("a-C").unwrap().eta, [2.94405, 2.22714, 1.96816]));
    }

    #[test]
    fn tables_become_rgb_by_role() {
        let table = Tabulated { lambda: vec![400.0, 500.0, 600.0, 700.0], values: vec![0.1, 0.5, 0.2, 0.9] };
        let near = |a: [f32; 3], b: [f32; 3]| (0..3).all(|c| (a[c] - b[c]).abs() < 2e-3);
        assert!(near(table.to_rgb(SpectrumRole::Albedo), [0.262351, 0.382156, 0.31049]));
        assert!(near(table.to_rgb(SpectrumRole::Illuminant), [0.340989, 0.358583, 0.276004]));
    }

    #[test]
    fn names() {
        assert!((dielectric_ior("diamond").unwrap() - 2.419).abs() < 1e-6);
        assert!((glass("BK7").unwrap().eval(587.6) - 1.5168).abs() < 1e-3);
        assert!(named_spectrum("metal-Cu-k").is_some() && named_spectrum("metal-Xx-k").is_none());
        assert!(spectrum_names().iter().all(|name| named_spectrum(name).is_some()));
    }

    /// The lists of Mitsuba 3.9 (its documentation and its package's data) and of pbrt-v4.
    #[test]
    fn both_formats_find_all_their_names() {
        let metals = "a-C Ag Al AlAs AlAs_palik AlSb AlSb_palik Au Be Be_palik Cr CsI CsI_palik Cu Cu_palik Cu2O Cu2O_palik CuO \
            CuO_palik d-C d-C_palik Hg Hg_palik HgTe HgTe_palik Ir Ir_palik K K_palik Li Li_palik MgO MgO_palik Mo Mo_palik \
            Na_palik Nb Nb_palik Ni_palik Rh Rh_palik Se Se_palik Se-e Se-e_palik SiC SiC_palik SnTe SnTe_palik Ta Ta_palik Te \
            Te_palik Te-e Te-e_palik ThF4 ThF4_palik TiC TiC_palik TiN TiN_palik TiO2 TiO2_palik TiO2-e TiO2-e_palik VC \
            VC_palik V_palik VN VN_palik W";
        assert!(metals.split_whitespace().all(|name| metal(name).is_some_and(|m| m.eta.eval(550.0) > 0.0)));
        let substances = "vacuum, helium, hydrogen, air, carbon dioxide, water, acetone, ethanol, carbon tetrachloride, \
            glycerol, benzene, silicone oil, bromine, water ice, fused quartz, pyrex, acrylic glass, polypropylene, bk7, \
            sodium chloride, amber, pet, diamond";
        assert!(substances.split(',').all(|name| dielectric_ior(name.trim()).is_some()));
        let of_pbrt = "glass-BK7 glass-BAF10 glass-FK51A glass-LASF9 glass-F5 glass-F10 glass-F11 metal-Ag-eta metal-Ag-k \
            metal-Al-eta metal-Al-k metal-Au-eta metal-Au-k metal-Cu-eta metal-Cu-k metal-CuZn-eta metal-CuZn-k \
            metal-MgO-eta metal-MgO-k metal-TiO2-eta metal-TiO2-k stdillum-A stdillum-D50 stdillum-D65 stdillum-F1 \
            stdillum-F2 stdillum-F3 stdillum-F4 stdillum-F5 stdillum-F6 stdillum-F7 stdillum-F8 stdillum-F9 stdillum-F10 \
            stdillum-F11 stdillum-F12 illum-acesD60";
        assert!(of_pbrt.split_whitespace().all(|name| named_spectrum(name).is_some()));
    }

    #[test]
    fn substances_scatter() {
        assert_eq!(scattering_substances().count(), 47);
        let milk = scattering_substances().find(|s| s.name == "Wholemilk").unwrap();
        assert_eq!((milk.scattering, milk.absorption), ([2.55, 3.21, 3.77], [0.0011, 0.0024, 0.014]));
        assert!(scattering_substances().any(|s| s.name == "Head & Shoulders Shampoo"));
    }

    #[test]
    fn a_hot_body_obeys_wien() {
        let table = blackbody(5000.0);
        let peak =
            (0..table.values.len()).max_by(|&a, &b| table.values[a].total_cmp(&table.values[b])).unwrap();
        assert!((table.lambda[peak] - 579.6).abs() < 5.0);
    }
}
