//! Where the sun stands over a place on Earth at a time.

use std::f64::consts::{PI, TAU};

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::Vector3;

/// The parameters of place and time, for the manual.
pub(super) const PARAMS: [ParamDoc; 9] = [
    ParamDoc { name: "latitude", ty: "float", default: "35.6894", doc: "of the place, degrees north" },
    ParamDoc { name: "longitude", ty: "float", default: "139.6917", doc: "of the place, degrees east" },
    ParamDoc { name: "timezone", ty: "float", default: "9", doc: "hours before universal time" },
    ParamDoc { name: "year", ty: "int", default: "2010", doc: "of the date" },
    ParamDoc { name: "month", ty: "int", default: "7", doc: "1 to 12" },
    ParamDoc { name: "day", ty: "int", default: "10", doc: "of the month" },
    ParamDoc { name: "hour", ty: "float", default: "15", doc: "local time" },
    ParamDoc { name: "minute", ty: "float", default: "0", doc: "of the hour" },
    ParamDoc { name: "second", ty: "float", default: "0", doc: "of the minute" },
];

/// A place and a time.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlaceAndTime {
    latitude: f64,
    longitude: f64,
    /// Days since noon of 1 January 2000, universal time.
    days: f64,
    /// Hours of the day, universal time.
    hours: f64,
}

impl PlaceAndTime {
    pub(super) fn from_params(params: &mut Params) -> Result<Self, SceneError> {
        let latitude = params.float_in("latitude", 35.6894, -90.0, 90.0)?;
        let longitude = params.float_in("longitude", 139.6917, -360.0, 360.0)?;
        let timezone = params.float_in("timezone", 9.0, -24.0, 24.0)?;
        let year = params.int_in("year", 2010, 1, 9999)?;
        let month = params.int_in("month", 7, 1, 12)?;
        let day = params.int_in("day", 10, 1, 31)?;
        let hour = params.float_in("hour", 15.0, 0.0, 24.0)?;
        let minutes = params.float("minute", 0.0)? + params.float("second", 0.0)? / 60.0;
        let hours = f64::from(hour - timezone + minutes / 60.0);
        let days = julian_day(year, month, day) as f64 - 0.5 + hours / 24.0 - 2_451_545.0;
        Ok(Self { latitude: f64::from(latitude), longitude: f64::from(longitude), days, hours })
    }

    /// Unit direction to the sun; +X is south, +Y is east, +Z is up.
    ///
    /// # References
    /// [Blanco-Muriel et al. 2001] "Computing the Solar Vector", Solar Energy 70(5).
    pub(super) fn sun(&self) -> Vector3 {
        let n = self.days;
        // Ecliptic coordinates.
        let omega = 2.1429 - 0.001_039_459_4 * n;
        let mean_longitude = 4.895_063_0 + 0.017_202_791_698 * n;
        let anomaly = 6.240_060_0 + 0.017_201_969_9 * n;
        let ecliptic_longitude =
            mean_longitude + 0.033_416_07 * anomaly.sin() + 0.000_348_94 * (2.0 * anomaly).sin()
                - 0.000_113_4
                - 0.000_020_3 * omega.sin();
        let obliquity = 0.409_092_8 - 6.2140e-9 * n + 0.000_039_6 * omega.cos();
        // Celestial coordinates.
        let sin_longitude = ecliptic_longitude.sin();
        let right_ascension =
            (obliquity.cos() * sin_longitude).atan2(ecliptic_longitude.cos()).rem_euclid(TAU);
        let declination = (obliquity.sin() * sin_longitude).asin();
        // Local coordinates.
        let greenwich = 6.697_424_324_2 + 0.065_709_828_3 * n + self.hours;
        let hour_angle = (greenwich * 15.0 + self.longitude).to_radians() - right_ascension;
        let (sin_latitude, cos_latitude) = self.latitude.to_radians().sin_cos();
        let cos_zenith =
            cos_latitude * hour_angle.cos() * declination.cos() + declination.sin() * sin_latitude;
        let zenith = cos_zenith.clamp(-1.0, 1.0).acos();
        let azimuth = (-hour_angle.sin())
            .atan2(declination.tan() * cos_latitude - sin_latitude * hour_angle.cos())
            .rem_euclid(TAU)
            - PI;
        // Parallax: the earth's radius over the distance to the sun.
        let zenith = zenith + 6371.01 / 149_597_890.0 * zenith.sin();
        let (sin, cos) = zenith.sin_cos();
        Vector3::new((sin * azimuth.cos()) as f32, (sin * azimuth.sin()) as f32, cos as f32)
    }
}

/// The Julian day that begins at noon of a date of the Gregorian calendar.
fn julian_day(year: i64, month: i64, day: i64) -> i64 {
    let early = (month - 14) / 12;
    (1461 * (year + 4800 + early)) / 4 + (367 * (month - 2 - 12 * early)) / 12
        - (3 * ((year + 4900 + early) / 100)) / 4
        + day
        - 32_075
}

#[cfg(test)]
mod tests {
    use super::*;
    use aureole_desc::Value;

    #[test]
    fn days_are_counted_from_their_epoch() {
        assert_eq!(julian_day(2000, 1, 1), 2_451_545);
        assert_eq!(julian_day(1858, 11, 17), 2_400_001);
    }

    /// Directions of another implementation (Mitsuba 3.9.1).
    #[test]
    fn the_sun_is_where_others_see_it() -> Result<(), SceneError> {
        let vienna =
            [("latitude", 48.0), ("longitude", 16.0), ("timezone", 1.0), ("hour", 10.0), ("minute", 20.0)];
        let mut vienna =
            vienna.into_iter().fold(Params::new(), |p, (name, value)| p.with(name, Value::Float(value)));
        for (name, value) in [("year", 2024), ("month", 3), ("day", 5)] {
            vienna = vienna.with(name, Value::Int(value));
        }
        let tokyo = Params::new().with("hour", Value::Float(8.0));
        for (mut params, expected) in [
            (vienna, Vector3::new(0.726_82, -0.449_223, 0.519_549)),
            (tokyo, Vector3::new(-0.010_881, -0.772_856, 0.634_488)),
        ] {
            let sun = PlaceAndTime::from_params(&mut params)?.sun();
            assert!((sun - expected).length() < 2e-3, "{sun:?} {expected:?}");
        }
        Ok(())
    }
}
