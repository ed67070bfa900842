use super::*;
use crate::Image;

/// A file of one directory and one strip: tags of sixteen bits each, and the strip's bytes.
fn file(size: [u16; 2], tags: &[(u16, &[u16])], strip: &[u8]) -> Vec<u8> {
    let rows = size[1];
    let mut all: Vec<(u16, Vec<u16>)> = tags.iter().map(|(tag, values)| (*tag, values.to_vec())).collect();
    all.extend([(256, vec![size[0]]), (257, vec![size[1]]), (278, vec![rows])]);
    let planes = if tags.contains(&(284, &[2])) { 3 } else { 1 };
    // The values of long tags follow the directory, and the strips follow them.
    let start = 8 + 2 + 12 * (all.len() + 2) + 4;
    let strips_at = start + 64 * all.len();
    let length = strip.len() / planes;
    let plane = |i: usize| (strips_at + i * length) as u16;
    all.push((273, (0..planes).map(plane).collect()));
    all.push((279, vec![length as u16; planes]));
    all.sort();
    let mut out = b"II*\0\x08\0\0\0".to_vec();
    out.extend((all.len() as u16).to_le_bytes());
    let mut values_of_long_tags = Vec::new();
    for (tag, values) in &all {
        out.extend([tag.to_le_bytes(), 3_u16.to_le_bytes()].concat());
        out.extend((values.len() as u32).to_le_bytes());
        let mut bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        if bytes.len() > 4 {
            out.extend(((start + values_of_long_tags.len()) as u32).to_le_bytes());
            values_of_long_tags.append(&mut bytes);
        } else {
            bytes.resize(4, 0);
            out.extend(bytes);
        }
    }
    out.extend([0; 4]);
    out.extend(values_of_long_tags);
    out.resize(strips_at, 0);
    out.extend(strip);
    out
}

fn read(bytes: &[u8]) -> Image {
    let raster = decode(bytes, &ImageLimits::default()).unwrap();
    // As stored: the curve of whole numbers is not what is tested here.
    let data = raster.texels.clone().into_floats();
    Image::from_data(raster.width, raster.height, raster.channels, data).unwrap()
}

#[test]
fn floats_of_every_width_are_read() {
    let values = [0.0_f64, 0.25, -3.5, 1024.0];
    let strips: [(u16, Vec<u8>); 3] = [
        (16, values.iter().flat_map(|&x| exr::prelude::f16::from_f64(x).to_le_bytes()).collect()),
        (32, values.iter().flat_map(|&x| (x as f32).to_le_bytes()).collect()),
        (64, values.iter().flat_map(|&x| x.to_le_bytes()).collect()),
    ];
    for (bits, strip) in strips {
        let image = read(&file([2, 2], &[(258, &[bits]), (262, &[1]), (339, &[3])], &strip));
        assert_eq!(image.data(), [0.0, 0.25, -3.5, 1024.0], "{bits}");
        let tags: [(u16, &[u16]); 4] = [(258, &[bits]), (262, &[2]), (277, &[4]), (339, &[3])];
        assert_eq!(read(&file([1, 1], &tags, &strip)).channels(), ["R", "G", "B", "A"]);
    }
}

#[test]
fn whole_numbers_of_every_width_are_read() {
    let grey = |bits: u16, format: u16, strip: &[u8]| {
        read(&file([2, 1], &[(258, &[bits]), (262, &[1]), (339, &[format])], strip)).data().to_vec()
    };
    assert_eq!(grey(1, 1, &[0b0100_0000]), [0.0, 255.0]);
    assert_eq!(grey(2, 1, &[0b0110_0000]), [85.0, 170.0]);
    assert_eq!(grey(4, 1, &[0x1f]), [17.0, 255.0]);
    assert_eq!(grey(8, 1, &[7, 200]), [7.0, 200.0]);
    assert_eq!(grey(16, 1, &[1, 2, 0, 255]), [513.0, 65280.0]);
    assert_eq!(grey(32, 1, &[0, 0, 1, 2, 255, 255, 255, 255]), [513.0, 65535.0]);
    assert_eq!(grey(16, 2, &[255, 127, 0, 128]), [65535.0, 0.0]);
}

/// Red, a grey of a half, and white, as each kind of colour stores them.
#[test]
fn every_kind_of_colour_is_read() {
    let reds: [u16; 12] = [65535, 32896, 65535, 0, 0, 32896, 65535, 0, 0, 32896, 65535, 0];
    type Tags<'a> = &'a [(u16, &'a [u16])];
    let kinds: [(&str, Tags<'_>, &[u8]); 6] = [
        ("rgb", &[(258, &[8, 8, 8]), (262, &[2]), (277, &[3])], &[255, 0, 0, 128, 128, 128, 255, 255, 255]),
        (
            "planes",
            &[(258, &[8, 8, 8]), (262, &[2]), (277, &[3]), (284, &[2])],
            &[255, 128, 255, 0, 128, 255, 0, 128, 255],
        ),
        ("palette", &[(258, &[2]), (262, &[3]), (320, &reds)], &[0b0001_1000]),
        (
            "cmyk",
            &[(258, &[8, 8, 8, 8]), (262, &[5]), (277, &[4])],
            &[0, 255, 255, 0, 0, 0, 0, 127, 0, 0, 0, 0],
        ),
        (
            "ycbcr",
            &[(258, &[8, 8, 8]), (262, &[6]), (277, &[3]), (530, &[1, 1])],
            &[76, 85, 255, 128, 128, 128, 255, 128, 128],
        ),
        (
            "rgb and alpha",
            &[(258, &[8, 8, 8, 8]), (262, &[2]), (277, &[4]), (338, &[2])],
            &[255, 0, 0, 9, 128, 128, 128, 9, 255, 255, 255, 9],
        ),
    ];
    for (name, tags, strip) in kinds {
        let image = read(&file([3, 1], tags, strip));
        let full = if name == "palette" { 65535.0 } else { 255.0 };
        let expected = [[1.0, 0.0, 0.0], [128.0 / 255.0; 3], [1.0; 3]];
        for (x, color) in expected.into_iter().enumerate() {
            let found = image.rgb(x, 0).map(|value| value / full);
            assert!((0..3).all(|c| (found[c] - color[c]).abs() < 0.006), "{name}: {found:?}, not {color:?}");
        }
        assert_eq!(image.channel("A").is_some(), name == "rgb and alpha", "{name}");
    }
    let inverted = file([2, 1], &[(258, &[8, 8]), (262, &[0]), (277, &[2]), (338, &[2])], &[0, 9, 55, 9]);
    assert_eq!(read(&inverted).data(), [255.0, 9.0, 200.0, 9.0]);
}

#[test]
fn pictures_lie_the_way_the_file_says() {
    for (orientation, stored) in
        [(1, [1, 2, 3, 4, 5, 6]), (3, [6, 5, 4, 3, 2, 1]), (6, [3, 6, 2, 5, 1, 4]), (8, [4, 1, 5, 2, 6, 3])]
    {
        let size = if orientation < 5 { [3, 2] } else { [2, 3] };
        let image =
            read(&file(size, &[(258, &[8]), (262, &[1]), (274, &[orientation])], &stored.map(|x: u8| x)));
        assert_eq!(image.width(), 3, "{orientation}");
        assert_eq!(image.data(), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0], "{orientation}");
    }
}

#[test]
fn what_cannot_be_read_says_so() {
    let lab = file([1, 1], &[(258, &[8, 8, 8]), (262, &[8]), (277, &[3])], &[1, 2, 3]);
    let halved = file([2, 2], &[(258, &[8, 8, 8]), (262, &[6]), (277, &[3])], &[1; 6]);
    for (bytes, word) in [(lab, "L*a*b*"), (halved, "lower resolution")] {
        let error = decode(&bytes, &ImageLimits::default()).unwrap_err().at("a.tif".as_ref()).to_string();
        assert!(error.contains(word), "{error}");
    }
    let huge = file([60_000, 60_000], &[(258, &[8]), (262, &[1])], &[0; 8]);
    assert!(decode(&huge, &ImageLimits::default()).is_err());
}
