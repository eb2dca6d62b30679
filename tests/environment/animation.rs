//! Law: an animation decodes to the frames that went in: exactly as PNG, closely as GIF.

use flockenv::FlockError;
use flockenv::draw::{AnimationEncoder, AnimationFormat};

const WIDTH: usize = 40;
const HEIGHT: usize = 30;

/// A square that moves over a pattern of 1200 colors; two frames are alike.
fn frames() -> Vec<Vec<u8>> {
    [0, 3, 3, 12, 25].map(frame).to_vec()
}

fn frame(place: usize) -> Vec<u8> {
    let color = |pixel: usize| {
        let (x, y) = (pixel % WIDTH, pixel / WIDTH);
        if (place..place + 5).contains(&x) && (place..place + 5).contains(&y) {
            [0xF0, 0xA2, 0x02]
        } else {
            [x as u8 * 5, y as u8 * 7, 128]
        }
    };
    (0..WIDTH * HEIGHT).flat_map(color).collect()
}

fn encoded(format: AnimationFormat, frames: &[Vec<u8>]) -> Vec<u8> {
    let mut encoder = AnimationEncoder::new(format, WIDTH as u32, HEIGHT as u32, 30.0).unwrap();
    for rgb in frames {
        encoder.add(&[HEIGHT, WIDTH, 3], rgb).unwrap();
    }
    encoder.finish().unwrap()
}

/// Draws a decoded rectangle over the picture so far; transparent pixels leave it as it is.
fn overlay(picture: &mut [u8], rgba: &[u8], left: usize, top: usize, width: usize) {
    for (index, pixel) in rgba.chunks_exact(4).enumerate() {
        if pixel[3] > 0 {
            let place = 3 * ((top + index / width) * WIDTH + left + index % width);
            picture[place..place + 3].copy_from_slice(&pixel[..3]);
        }
    }
}

#[test]
fn png_is_exact() {
    let frames = frames();
    let bytes = encoded(AnimationFormat::Apng, &frames);
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes))
        .read_info()
        .unwrap();
    let control = reader.info().animation_control.unwrap();
    assert_eq!((control.num_frames, control.num_plays), (5, 0));
    let mut picture = vec![0; frames[0].len()];
    let mut buffer = vec![0; WIDTH * HEIGHT * 4];
    for expected in &frames {
        reader.next_frame(&mut buffer).unwrap();
        let shown = *reader.info().frame_control().unwrap();
        assert_eq!((shown.delay_num, shown.delay_den), (100, 3000));
        let (width, height) = (shown.width as usize, shown.height as usize);
        let (left, top) = (shown.x_offset as usize, shown.y_offset as usize);
        overlay(
            &mut picture,
            &buffer[..4 * width * height],
            left,
            top,
            width,
        );
        assert_eq!(&picture, expected);
    }
    assert!(reader.next_frame(&mut buffer).is_err(), "no frame is left");
}

#[test]
fn gif_is_close_and_keeps_time() {
    let frames = frames();
    let bytes = encoded(AnimationFormat::Gif, &frames);
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let mut decoder = options.read_info(bytes.as_slice()).unwrap();
    let mut picture = vec![0; frames[0].len()];
    let mut delays = Vec::new();
    for expected in &frames {
        let shown = decoder.read_next_frame().unwrap().unwrap();
        delays.push(shown.delay);
        let (left, top) = (usize::from(shown.left), usize::from(shown.top));
        overlay(
            &mut picture,
            &shown.buffer,
            left,
            top,
            usize::from(shown.width),
        );
        let apart = |(a, b): (&u8, &u8)| f64::from(a.abs_diff(*b));
        let error: f64 = picture.iter().zip(expected).map(apart).sum();
        assert!(error / (picture.len() as f64) < 6.0, "mean error {error}");
    }
    assert!(decoder.read_next_frame().unwrap().is_none());
    // 30 frames per second in hundredths: 3.33 each.
    assert_eq!(delays, [3, 4, 3, 3, 4]);
}

#[test]
fn few_colors_are_exact_as_gif() {
    let plain = |level: u8| vec![level; WIDTH * HEIGHT * 3];
    let bytes = encoded(AnimationFormat::Gif, &[plain(7), plain(200)]);
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let mut decoder = options.read_info(bytes.as_slice()).unwrap();
    for level in [7, 200] {
        let shown = decoder.read_next_frame().unwrap().unwrap();
        assert_eq!(shown.buffer[..4], [level, level, level, 255]);
    }
}

#[test]
fn bad_input_is_refused() {
    for format in [AnimationFormat::Apng, AnimationFormat::Gif] {
        for (width, height, fps) in [
            (0, 10, 10.0),
            (10, 65_536, 10.0),
            (10, 10, 0.0),
            (10, 10, f64::NAN),
            (10, 10, 101.0),
        ] {
            let refused = AnimationEncoder::new(format, width, height, fps);
            assert!(matches!(refused, Err(FlockError::Parameter { .. })));
        }
        let mut encoder = AnimationEncoder::new(format, 2, 1, 10.0).unwrap();
        for shape in [&[1, 2, 4][..], &[2, 1, 3], &[1, 2], &[]] {
            let refused = encoder.add(shape, &[0; 6]);
            assert!(matches!(refused, Err(FlockError::Shape { .. })));
        }
        assert!(encoder.add(&[1, 2, 3], &[0; 5]).is_err());
        assert!(matches!(
            encoder.finish(),
            Err(FlockError::Parameter { .. })
        ));
    }
}
