//! Relative spectral power of the CIE's standard illuminants A, D50, D65 and F1 to F12, and of ACES' D60.
//!
//! # References
//! CIE 15:2004, tables T.1 and T.6.1, every five nanometres; beyond 780 nm, where they end, A by its defining equation
//! and D50 by the daylight basis. D60 is the CIE daylight of 6000 K · 1.4388 / 1.438 that SMPTE ST 2065-1 names.

use std::sync::{Arc, OnceLock};

use crate::Tabulated;

/// All illuminants by pbrt's names: `stdillum-A`, `stdillum-D65`, …, `illum-acesD60`.
fn illuminants() -> &'static [(&'static str, Arc<Tabulated>)] {
    static TABLE: OnceLock<Vec<(&'static str, Arc<Tabulated>)>> = OnceLock::new();
    TABLE.get_or_init(|| {
        let mut lines = include_str!("../data/illuminants.csv").lines();
        let names = lines.next().unwrap_or_default().split(',').skip(1);
        let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
        let number = |row: &[&str], column: usize| row.get(column)?.parse::<f32>().ok();
        let column = |c: usize| -> Arc<Tabulated> {
            // The fluorescent lamps are only known from 380 to 780 nm: elsewhere their fields are empty.
            let samples = rows.iter().filter_map(|row| Some((number(row, 0)?, number(row, c)?)));
            let (lambda, values) = samples.unzip();
            Arc::new(Tabulated { lambda, values })
        };
        names.enumerate().map(|(i, name)| (name, column(i + 1))).collect()
    })
}

/// The illuminant of that name.
pub(crate) fn illuminant(name: &str) -> Option<Arc<Tabulated>> {
    illuminants().iter().find(|(known, _)| *known == name).map(|(_, table)| table.clone())
}

/// The names of all illuminants.
pub(crate) fn illuminant_names() -> impl Iterator<Item = &'static str> {
    illuminants().iter().map(|(name, _)| *name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chromaticities_are_those_that_the_cie_publishes() {
        let published = [
            ("stdillum-A", [0.44757, 0.40745]),
            ("stdillum-D50", [0.34567, 0.35850]),
            ("stdillum-D65", [0.31272, 0.32903]),
            ("illum-acesD60", [0.32168, 0.33767]),
            ("stdillum-F1", [0.3131, 0.3371]),
            ("stdillum-F2", [0.3721, 0.3751]),
            ("stdillum-F7", [0.3129, 0.3292]),
            ("stdillum-F11", [0.3805, 0.3769]),
            ("stdillum-F12", [0.4370, 0.4042]),
        ];
        for (name, expected) in published {
            let [x, y, z] = illuminant(name).unwrap().to_xyz(false);
            let found = [x / (x + y + z), y / (x + y + z)];
            assert!((0..2).all(|c| (found[c] - expected[c]).abs() < 5e-4), "{name}: {found:?}");
        }
        assert_eq!(illuminant_names().count(), 16);
    }
}
