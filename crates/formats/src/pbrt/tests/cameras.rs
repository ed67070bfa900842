//! Cameras, films and the options that decide where samples lie.

use aureole_desc::{Params, Value};

use super::{good, mistake, warnings};

/// The kind and the parameters of the only camera.
fn camera(text: &str) -> (String, Params) {
    let desc = good(&format!("{text} WorldBegin"));
    let node = &desc[desc.cameras[0]];
    (node.kind.clone(), node.params.clone())
}

#[test]
fn a_realistic_camera_has_its_lens_from_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("glass.dat");
    std::fs::write(&file, "# front\n50 5 1.5 20\n-50\t40 1 20 # rear\n").unwrap();
    let text = |more: &str| {
        format!(
            "Film \"rgb\" \"float diagonal\" 43 Camera \"realistic\" \"string lensfile\" \"{}\" {more}",
            file.display()
        )
    };
    let (kind, mut params) = camera(&text("\"float aperturediameter\" 8 \"string aperture\" \"star\""));
    assert_eq!(kind, "realistic");
    let rows = params.try_floats("lens").unwrap().unwrap();
    assert_eq!(*rows, [50.0, 5.0, 1.5, 20.0, -50.0, 40.0, 1.0, 20.0]);
    let numbers = ["film_diagonal", "aperture_diameter"].map(|name| params.float(name, 0.0).unwrap());
    assert_eq!(numbers, [43.0, 8.0]);
    assert_eq!(params.get("aperture"), Some(&Value::String("star".into())));
    let (_, mut params) = camera(&text("\"string aperture\" \"dust.png\""));
    assert!(params.try_path("aperture_picture").unwrap().is_some_and(|path| path.ends_with("dust.png")));

    // pbrt takes the window of a realistic camera from its film alone.
    let said = warnings(&text("\"float screenwindow\" [-1 1 -1 1] WorldBegin"));
    assert!(said.iter().any(|w| w.contains("screenwindow")), "{said:?}");
    std::fs::write(&file, "50 5 1.5 20\n-50 40 air 20\n").unwrap();
    let (message, place) = mistake(&text("WorldBegin"));
    assert!(message.contains("line 2") && message.contains("`air`") && place.0 == 1, "{message}");
    assert!(mistake("Camera \"realistic\" WorldBegin").0.contains("lensfile"));
}

/// With a lens, pbrt's orthographic rays run from one point of it to their pixel's place in the plane of focus: those of
/// a perspective camera.
#[test]
fn an_orthographic_lens_is_in_the_middle_of_the_image() {
    let window = "\"float screenwindow\" [-3 1 -2 2]";
    let (kind, mut params) = camera(&format!("Camera \"orthographic\" {window}"));
    assert_eq!(
        (kind.as_str(), &*params.try_floats("screen_window").unwrap().unwrap()),
        ("orthographic", &[-3.0, 1.0, -2.0, 2.0][..])
    );
    let lens = "\"float lensradius\" 0.1 \"float focaldistance\" 4";
    let (kind, mut params) = camera(&format!("Camera \"orthographic\" {window} {lens}"));
    assert_eq!(kind, "perspective");
    assert_eq!(*params.try_floats("screen_window").unwrap().unwrap(), [-0.75, 0.25, -0.5, 0.5]);
    let lens = ["aperture_radius", "focus_distance"].map(|name| params.float(name, 0.0).unwrap());
    assert_eq!(lens, [0.1, 4.0]);
}

/// Without jitter all samples lie in the middle of their pixel, whatever filter is asked for.
#[test]
fn pixel_jitter_is_switched_off() {
    let filter = |text: &str| {
        let desc = good(&format!("{text} PixelFilter \"gaussian\" WorldBegin"));
        let node = &desc[desc.filter.unwrap()];
        (node.kind.clone(), node.params.clone().vec2("radius", [0.0; 2]).unwrap())
    };
    assert_eq!(filter("Option \"disablepixeljitter\" false"), ("gaussian".into(), [1.5; 2]));
    let (kind, radius) = filter("Option \"disable-pixel-jitter\" true");
    assert!(kind == "box" && radius.iter().all(|r| (0.0..1e-4).contains(r)), "{kind} {radius:?}");
    assert!(warnings("Option \"disablewavelengthjitter\" true WorldBegin").is_empty());
    assert!(mistake("Option \"disablepixeljitter\" 1 WorldBegin").0.contains("`true` or `false`"));
}
