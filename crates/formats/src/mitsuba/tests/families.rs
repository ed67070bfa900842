use super::{read, show, show_bsdf, show_shape};

#[test]
fn materials() {
    for (xml, text) in [
        (
            r##"<bsdf type="diffuse"><rgb name="reflectance" value="#ff0000"/></bsdf>"##,
            "diffuse(reflectance=Rgb([1.0, 0.0, 0.0]))",
        ),
        (
            r#"<bsdf type="diffuse"><rgb name="reflectance" value=".5"/></bsdf>"#,
            "diffuse(reflectance=Rgb([0.5, 0.5, 0.5]))",
        ),
        (
            r#"<bsdf type="diffuse"><spectrum name="reflectance" value="0.3"/></bsdf>"#,
            "diffuse(reflectance=Uniform(0.3))",
        ),
        (r#"<bsdf type="conductor"/>"#, "conductor(material=none)"),
        (r#"<bsdf type="conductor"><string name="material" value="Au"/></bsdf>"#, "conductor(material=Au)"),
        (
            r#"<bsdf type="conductor"><spectrum name="eta" value="0.8"/></bsdf>"#,
            "conductor(k=Uniform(1.0) eta=Uniform(0.8))",
        ),
        (
            r#"<bsdf type="roughconductor"><float name="alpha" value="0.2"/></bsdf>"#,
            "rough_conductor(material=none distribution=beckmann alpha=0.2)",
        ),
        (
            r#"<bsdf type="dielectric"><string name="int_ior" value="water"/></bsdf>"#,
            "dielectric(int_ior=water)",
        ),
        (
            r#"<bsdf type="roughplastic"><boolean name="nonlinear" value="true"/><boolean name="sample_visible" value="false"/></bsdf>"#,
            "rough_plastic(distribution=beckmann nonlinear=true)",
        ),
        (
            r#"<bsdf type="twosided"><bsdf type="null"/><bsdf type="plastic"/></bsdf>"#,
            "two_sided(bsdf=null() back=plastic())",
        ),
        (
            r#"<bsdf type="mask"><float name="opacity" value="0.2"/><bsdf type="diffuse"/></bsdf>"#,
            "mask(bsdf=diffuse() opacity=0.2)",
        ),
        (
            r#"<bsdf type="blendbsdf"><float name="weight" value="0.2"/><bsdf type="diffuse"/><bsdf type="null"/></bsdf>"#,
            "blend(a=diffuse() b=null() dirac=density_one weight=0.2)",
        ),
        (
            r#"<bsdf type="bumpmap"><texture name="any" type="checkerboard"/><float name="scale" value="2"/><bsdf type="diffuse"/></bsdf>"#,
            "bump(texture=checkerboard(swap_numbers=true) bsdf=diffuse() scale=2)",
        ),
        (
            r#"<bsdf type="normalmap"><texture name="normalmap" type="mesh_attribute"><string name="name" value="vertex_n"/></texture><bsdf type="diffuse"/></bsdf>"#,
            "normal_map(texture=mesh_attribute(name=vertex_n) bsdf=diffuse())",
        ),
        (
            r#"<bsdf type="principledthin"><float name="eta" value="1.33"/></bsdf>"#,
            "principled_thin(eta=1.33)",
        ),
    ] {
        assert_eq!(show_bsdf(xml), text);
    }
}

#[test]
fn shapes() {
    for (xml, text) in [
        (
            r#"<shape type="sphere"><point name="center" x="1" z="2"/><float name="radius" value="3"/></shape>"#,
            "sphere(center=[1.0, 0.0, 2.0] radius=3)",
        ),
        (
            r#"<shape type="cylinder"><point name="p1" value="0, 0, 2"/><boolean name="flip_normals" value="true"/></shape>"#,
            "cylinder(p1=[0.0, 0.0, 2.0] flip_normals=true)",
        ),
        (r#"<shape type="disk"><transform name="to_world"/></shape>"#, "disk(world_from_object=identity)"),
        (
            r#"<shape type="rectangle"><emitter type="area"><rgb name="radiance" value="2"/></emitter></shape>"#,
            "rectangle(emission=area(radiance=Rgb([2.0, 2.0, 2.0])) bsdf=diffuse(reflectance=Uniform(0.0)))",
        ),
        (
            r#"<shape type="cube"><medium name="interior" type="homogeneous"><phase type="hg"><float name="g" value="0.5"/></phase></medium></shape>"#,
            "cube(interior=homogeneous(phase=hg g=0.5))",
        ),
    ] {
        assert_eq!(show_shape(xml), text);
    }
    let mirrored = r#"<shape type="sphere"><transform name="to_world"><scale x="-1"/></transform></shape>"#;
    assert!(show_shape(mirrored).starts_with("sphere(flip_normals=true"));
    let (scene, _) = read(
        r#"<shape type="merge"><shape type="cube"/><shape type="merge"><shape type="disk"/></shape></shape>"#,
    );
    assert_eq!(scene.shapes.len(), 2);
}

#[test]
fn instances_are_named_or_take_few_bytes() {
    let group = r#"<shape type="shapegroup" id="g"><shape type="cube"/><shape type="disk"/></shape>"#;
    let instance = |id: &str| {
        format!(
            r#"<shape type="instance"{id}><ref id="g"/><transform name="to_world"><translate x="2"/></transform></shape>"#
        )
    };
    let (scene, warnings) = read(&format!("{group}{}{}", instance(""), instance(" id=\"i\"")));
    assert!(warnings.is_empty() && scene.instances.len() == 1 && scene.shapes.len() == 1, "{warnings:?}");
    assert_eq!(show(&scene, scene.instances[0].group), "group(shapes=[cube(), disk()])");
    assert_eq!(scene.instances[0].world_from_object[0], [1.0, 0.0, 0.0, 2.0]);
    assert!(show(&scene, scene.shapes[0]).starts_with("instance("));
}

#[test]
fn transforms_apply_in_order() {
    let shown = |steps: &str| {
        show_shape(&format!("<shape type=\"disk\"><transform name=\"to_world\">{steps}</transform></shape>"))
    };
    assert_eq!(
        shown(r#"<translate x="1"/><scale value="2"/><rotate z="1" angle="90"/>"#),
        "disk(world_from_object=[[0.0, -2.0, 0.0, 0.0], [2.0, 0.0, 0.0, 2.0], [0.0, 0.0, 2.0, 0.0], [0.0, 0.0, 0.0, 1.0]])"
    );
    assert_eq!(
        shown(r#"<matrix value="1 2 0 0 1 0 0 0 1"/><translate value="1, 2, 3"/>"#),
        "disk(world_from_object=[[1.0, 2.0, 0.0, 1.0], [0.0, 1.0, 0.0, 2.0], [0.0, 0.0, 1.0, 3.0], [0.0, 0.0, 0.0, 1.0]])"
    );
    assert_eq!(
        shown(r#"<lookat origin="0,0,5" target="0 0 0" up="0, 1, 0"/>"#),
        "disk(world_from_object=[[-1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, -1.0, 5.0], [0.0, 0.0, 0.0, 1.0]])"
    );
}

#[test]
fn lights() {
    let (scene, warnings) = read(
        r#"<emitter type="point"><point name="position" x="1" y="2" z="3"/><spectrum name="intensity" value="400:1, 700:2"/></emitter>
        <emitter type="spot"><float name="cutoff_angle" value="30"/><float name="sampling_weight" value="2"/></emitter>
        <emitter type="directional"><vector name="direction" value="0, -1, 0"/><float name="irradiance" value="2"/></emitter>
        <emitter type="constant"><spectrum name="radiance" type="d65"><float name="scale" value="3"/></spectrum></emitter>
        <emitter type="projector"><float name="fov" value="20"/></emitter>
        <emitter type="area" id="unused"/>"#,
    );
    assert!(warnings.is_empty(), "{warnings:?}");
    let shown: Vec<_> = scene.lights.iter().map(|&id| show(&scene, id)).collect();
    assert_eq!(
        shown,
        [
            "point(position=[1.0, 2.0, 3.0] intensity=Tabulated(Tabulated { lambda: [400.0, 700.0], values: [1.0, 2.0] }))",
            "spot(cutoff_angle=30)",
            "directional(direction=[0.0, -1.0, 0.0] irradiance=2)",
            "constant(radiance=Rgb([3.0, 3.0, 3.0]))",
            "projector(fov_axis=x flip_v=true scale=3.141592653589793 fov=20)",
        ]
    );
    // A spectrum of constant power is not white: it stays a spectrum in lights.
    let (scene, _) = read(r#"<emitter type="constant"><spectrum name="radiance" value="2"/></emitter>"#);
    assert!(show(&scene, scene.lights[0]).contains("Tabulated"));
}

#[test]
fn skies_over_a_span_of_time_are_those_of_its_begin() {
    let sky = r#"<emitter type="timed_sunsky"><integer name="start_month" value="3"/><float name="window_start_time" value="9"/><integer name="end_year" value="2030"/></emitter>"#;
    let (scene, warnings) = read(sky);
    assert!(warnings.is_empty(), "{warnings:?}");
    assert_eq!(show(&scene, scene.lights[0]), "sunsky(year=2025 month=3 day=1 hour=9)");
    let shutter = r#"<sensor type="perspective"><float name="shutter_close" value="1"/></sensor>"#;
    let (_, warnings) = read(&format!("{sky}{shutter}"));
    assert_eq!(
        warnings,
        ["time does not move the sun: the sky is that of the moment in which the shutter opens"]
    );
}

#[test]
fn meters_look_along_their_direction() {
    let (scene, warnings) = read(
        r#"<sensor type="radiancemeter"><point name="origin" value="1, 2, 3"/><vector name="direction" value="0, 0, -2"/></sensor>
        <sensor type="distant"><vector name="direction" value="0, 1, 0"/><point name="target" value="0, 0, 1"/></sensor>"#,
    );
    assert!(warnings.is_empty(), "{warnings:?}");
    let shown: Vec<_> = scene.cameras.iter().map(|&id| show(&scene, id)).collect();
    assert!(shown[0].starts_with("radiance_meter(world_from_camera="), "{shown:?}");
    assert!(shown[1].starts_with("distant(world_from_camera=") && shown[1].contains("target="), "{shown:?}");
}

#[test]
fn optical_filters_are_seen_by_unpolarised_light() {
    let filter = r#"<bsdf type="polarizer"><spectrum name="theta" value="90"/><rgb name="transmittance" value="0.5"/></bsdf>"#;
    assert_eq!(show_bsdf(filter), "null(scale=0.5 transmittance=Rgb([0.5, 0.5, 0.5]))");
    assert_eq!(
        show_bsdf(r#"<bsdf type="circular"><boolean name="left_handed" value="true"/></bsdf>"#),
        "null(scale=0.5)"
    );
    assert_eq!(show_bsdf(r#"<bsdf type="retarder"><float name="delta" value="90"/></bsdf>"#), "null()");
    let plastic = r#"<bsdf type="pplastic"><float name="alpha" value="0.06"/></bsdf>"#;
    assert_eq!(show_bsdf(plastic), "baek_plastic(distribution=beckmann alpha=0.06)");
}

#[test]
fn cameras_with_what_hangs_below_them() {
    let (scene, warnings) = read(
        r#"<sensor type="thinlens"><float name="aperture_radius" value="0.1"/><string name="focal_length" value="50mm"/>
            <film type="hdrfilm"><integer name="crop_offset_x" value="3"/><string name="pixel_format" value="luminance"/><rfilter type="lanczos"><integer name="lobes" value="2"/></rfilter></film>
            <sampler type="multijitter"><integer name="sample_count" value="9"/><integer name="seed" value="3"/></sampler></sensor>
        <sensor type="perspective"><float name="fov" value="30"/><float name="focus_distance" value="9"/><film type="hdrfilm"/></sensor>
        <sensor type="orthographic"/>"#,
    );
    assert!(warnings.iter().all(|warning| warning.contains("first sensor")), "{warnings:?}");
    let shown: Vec<_> = scene.cameras.iter().map(|&id| show(&scene, id)).collect();
    assert_eq!(
        shown,
        [
            "perspective(fov=46.793003343965566 fov_axis=diagonal focus_distance=10000 aperture_radius=0.1)",
            "perspective(fov_axis=x fov=30)",
            "orthographic()",
        ]
    );
    let root = |id: Option<_>| show(&scene, id.unwrap());
    assert_eq!(root(scene.film), "film(width=768 height=576 pixel_format=luminance crop_x=3)");
    assert_eq!(root(scene.filter), "lanczos(radius=2 tau=2)");
    assert_eq!(root(scene.sampler), "sobol(sample_count=9)");
}

#[test]
fn cameras_beside_each_other_and_on_shapes() {
    let (scene, warnings) = read(
        r#"<sensor type="batch">
            <sensor type="perspective"><string name="fov_axis" value="y"/><float name="fov" value="90"/></sensor>
            <sensor type="orthographic"/>
            <film type="hdrfilm"><integer name="width" value="8"/></film>
        </sensor>
        <shape type="disk"><sensor type="irradiancemeter"><film type="hdrfilm"/></sensor></shape>"#,
    );
    assert!(warnings.iter().all(|warning| warning.contains("first sensor")), "{warnings:?}");
    let shown: Vec<_> = scene.cameras.iter().map(|&id| show(&scene, id)).collect();
    // The first one's axis is that of a film of 768 by 576.
    let first = "perspective(fov_axis=x fov=106.26020470831195)";
    assert_eq!(
        shown,
        [format!("batch(cameras=[{first}, orthographic()])"), "irradiance_meter(shape=disk())".to_owned()]
    );
    assert_eq!(show(&scene, scene.film.unwrap()), "film(height=576 width=8)");
}

#[test]
fn integrators() {
    for (xml, text) in [
        (
            r#"<integrator type="path"><integer name="max_depth" value="6"/></integrator>"#,
            "path(see_through=false max_depth=6)",
        ),
        (
            r#"<integrator type="direct"><integer name="shading_samples" value="3"/></integrator>"#,
            "direct(emitter_samples=3 bsdf_samples=3)",
        ),
        (
            r#"<integrator type="moment"><integrator type="path"/></integrator>"#,
            "path(see_through=false layers=_arg_0:xyz,m2__arg_0:xyz2)",
        ),
        (r#"<integrator type="ptracer"/>"#, "path(see_through=false)"),
        (r#"<integrator type="direct_projective"><integer name="sppi" value="4"/></integrator>"#, "direct()"),
        (
            r#"<integrator type="prb_projective"><string name="guiding" value="grid"/></integrator>"#,
            "path(see_through=false)",
        ),
        (r#"<integrator type="depth"/>"#, "depth(from_near_clip=true)"),
        (r#"<integrator type="volpath"/>"#, "path()"),
        (
            r#"<integrator type="aov"><string name="aovs" value="nn:sh_normal"/></integrator>"#,
            "aov(layers=nn:sh_normal)",
        ),
        (
            r#"<integrator type="aov"><string name="aovs" value="dd.y:depth, uv:uv"/><integrator type="path" name="image"/></integrator>"#,
            "path(see_through=false layers=image:radiance,dd.y:depth,uv:uv)",
        ),
        (
            r#"<integrator type="aov"><string name="aovs" value="d:depth"/><integrator type="moment" name="m"><integrator type="direct" name="p"/></integrator></integrator>"#,
            "direct(layers=m:radiance,d:depth,m.p:xyz,m.m2_p:xyz2)",
        ),
    ] {
        let (scene, warnings) = read(xml);
        assert!(warnings.is_empty(), "{warnings:?}");
        assert_eq!(show(&scene, scene.integrator.unwrap()), text);
    }
    let (scene, warnings) = read(
        r#"<integrator type="aov"><string name="aovs" value="dd:depth,d:boundary_test"/><integrator type="path"/></integrator>"#,
    );
    assert_eq!(
        show(&scene, scene.integrator.unwrap()),
        "path(see_through=false layers=_arg_0:radiance,dd:depth)"
    );
    assert_eq!(warnings, ["the layer `d:boundary_test` is left out"]);
    let (_, warnings) = read(r#"<integrator type="volpath"/><medium type="homogeneous" id="m"/>"#);
    assert_eq!(warnings, ["participating media are not rendered yet: `volpath` is rendered as `path`"]);
}

#[test]
fn constant_textures_are_spectra() {
    let reflectance = |xml: &str| show_bsdf(&format!("<bsdf type=\"diffuse\">{xml}</bsdf>"));
    let regular = r#"<texture name="reflectance" type="regular"><float name="wavelength_min" value="400"/><float name="wavelength_max" value="700"/><string name="values" value="1, 2, 3"/></texture>"#;
    assert_eq!(
        reflectance(regular),
        "diffuse(reflectance=Tabulated(Tabulated { lambda: [400.0, 550.0, 700.0], values: [1.0, 2.0, 3.0] }))"
    );
    let raw =
        r#"<texture name="reflectance" type="rawconstant"><vector name="value" value="1, 2, 3"/></texture>"#;
    assert_eq!(reflectance(raw), "diffuse(reflectance=Rgb([1.0, 2.0, 3.0]))");
    let uniform =
        r#"<spectrum name="reflectance" type="uniform"><float name="value" value="0.25"/></spectrum>"#;
    assert_eq!(reflectance(uniform), "diffuse(reflectance=Uniform(0.25))");
}

#[test]
fn old_scenes_are_brought_up_to_date() {
    let text = r#"<scene version="0.6.0"><shape type="disk"><transform name="toWorld"><translate x="1"/></transform>
        <bsdf type="roughdielectric"><string name="intIOR" value="bk7"/><float name="alphaU" value="0.1"/></bsdf></shape></scene>"#;
    let scene = super::read_with(text, &Default::default()).result.unwrap();
    assert_eq!(
        show(&scene, scene.shapes[0]),
        "disk(bsdf=rough_dielectric(distribution=beckmann int_ior=bk7 alpha_u=0.1) \
         world_from_object=[[1.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]])"
    );
}
