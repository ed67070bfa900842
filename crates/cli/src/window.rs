//! `--resolution` and `--crop`: the size of the image and the part of it that is rendered.

use aureole::desc::{Family, Node, Params, SceneDesc, SceneError, Span, Value};
use aureole::scene::Crop;

use crate::args::{Corners, SceneArgs, Size};

/// The size of a scene that says nothing about it.
const DEFAULT: Size = Size { width: 256, height: 256 };
const CROP: [&str; 4] = ["crop_x", "crop_y", "crop_width", "crop_height"];

/// Changes a scene's film as the command line asks.
///
/// # Errors
/// A part without pixels.
pub(crate) fn apply(args: &SceneArgs, desc: &mut SceneDesc) -> Result<(), SceneError> {
    let window = args.crop_window.map(|Corners([x0, x1, y0, y1])| Corners([x0, y0, x1, y1]));
    let corners = args.crop.or(window);
    if args.resolution.is_none() && corners.is_none() {
        return Ok(());
    }
    let film = match desc.film {
        Some(film) => film,
        None => desc.add(Node::new(Family::Film, "film", Params::new(), Span::NONE)),
    };
    desc.film = Some(film);
    let params = &mut desc[film].params;
    let old =
        Size { width: int(params, "width", DEFAULT.width), height: int(params, "height", DEFAULT.height) };
    let size = args.resolution.unwrap_or(old);
    if let Some(corners) = corners {
        set_crop(params, part(corners, size)?);
    } else if CROP.iter().any(|name| params.has(name)) {
        let crop = scaled(old_crop(params, old), old, size)?;
        set_crop(params, crop);
    }
    set(params, "width", size.width);
    set(params, "height", size.height);
    Ok(())
}

fn int(params: &Params, name: &str, default: u32) -> u32 {
    match params.get(name) {
        Some(&Value::Int(i)) => u32::try_from(i).unwrap_or(default),
        _ => default,
    }
}

fn set(params: &mut Params, name: &str, value: u32) {
    params.push(name, Value::Int(value.into()), Span::NONE);
}

fn old_crop(params: &Params, size: Size) -> Crop {
    let (x, y) = (int(params, "crop_x", 0), int(params, "crop_y", 0));
    let width = int(params, "crop_width", size.width.saturating_sub(x));
    let height = int(params, "crop_height", size.height.saturating_sub(y));
    Crop { x, y, width, height }
}

fn set_crop(params: &mut Params, crop: Crop) {
    for (name, value) in CROP.into_iter().zip([crop.x, crop.y, crop.width, crop.height]) {
        set(params, name, value);
    }
}

/// The same part of an image of another size.
fn scaled(crop: Crop, old: Size, new: Size) -> Result<Crop, SceneError> {
    let fraction = |x: u32, whole: u32| f64::from(x) / f64::from(whole.max(1));
    part(
        Corners([
            fraction(crop.x, old.width),
            fraction(crop.y, old.height),
            fraction(crop.x.saturating_add(crop.width), old.width),
            fraction(crop.y.saturating_add(crop.height), old.height),
        ]),
        new,
    )
}

/// Pixels from fractions where all numbers are within 0 to 1, else as they are; clipped to the image.
fn part(Corners(corners): Corners, size: Size) -> Result<Crop, SceneError> {
    let [x0, y0, x1, y1] = if corners.iter().all(|x| (0.0..=1.0).contains(x)) {
        let (width, height) = (f64::from(size.width), f64::from(size.height));
        [corners[0] * width, corners[1] * height, corners[2] * width, corners[3] * height]
    } else {
        corners
    };
    // Rounding both edges the same way lets neighbouring parts meet.
    let pixel = |x: f64, whole: u32| (x.round() as u32).min(whole);
    let (left, right) = (pixel(x0, size.width), pixel(x1, size.width));
    let (top, bottom) = (pixel(y0, size.height), pixel(y1, size.height));
    if right <= left || bottom <= top {
        let message = format!("this part of {} x {} pixels is empty", size.width, size.height);
        return Err(SceneError::invalid(message, Span::NONE));
    }
    Ok(Crop { x: left, y: top, width: right - left, height: bottom - top })
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: Size = Size { width: 200, height: 100 };

    #[test]
    fn fractions_and_pixels_are_told_apart() {
        let middle = Crop { x: 50, y: 25, width: 100, height: 50 };
        assert_eq!(part(Corners([0.25, 0.25, 0.75, 0.75]), SIZE).unwrap(), middle);
        assert_eq!(part(Corners([50.0, 25.0, 150.0, 75.0]), SIZE).unwrap(), middle);
        assert_eq!(part(Corners([0.0, 0.0, 1.0, 1.0]), SIZE).unwrap().width, 200);
        assert_eq!(part(Corners([150.0, 50.0, 999.0, 999.0]), SIZE).unwrap().height, 50);
        assert!(part(Corners([0.5, 0.0, 0.5, 1.0]), SIZE).is_err());
    }

    #[test]
    fn a_new_resolution_keeps_the_scene_s_crop() {
        let mut desc = SceneDesc::default();
        for (path, value) in [("film.width", "200"), ("film.height", "100"), ("film.crop_x", "100")] {
            desc.set(path, value).unwrap();
        }
        let args = SceneArgs { resolution: Some(Size { width: 50, height: 25 }), ..SceneArgs::default() };
        apply(&args, &mut desc).unwrap();
        let params = &desc[desc.film.unwrap()].params;
        assert_eq!(old_crop(params, SIZE), Crop { x: 25, y: 0, width: 25, height: 25 });
    }

    #[test]
    fn pbrt_s_order_is_understood() {
        let mut desc = SceneDesc::default();
        let args = SceneArgs { crop_window: Some(Corners([0.0, 0.5, 0.25, 1.0])), ..SceneArgs::default() };
        apply(&args, &mut desc).unwrap();
        let params = &desc[desc.film.unwrap()].params;
        assert_eq!(old_crop(params, SIZE), Crop { x: 0, y: 64, width: 128, height: 192 });
    }
}
