//! A division moves in every format.

use crate::common::command::answer;

#[test]
fn a_division_moves() {
    let folder = tempfile::tempdir().unwrap();
    let movie = |name: &str| {
        let arguments = ["divide", "--r0", "4", "--cue", "germline", "--movie", name, "--movie-frames", "4"];
        answer(folder.path(), &arguments);
        std::fs::read(folder.path().join(name)).unwrap()
    };
    let bytes = movie("a.gif");
    let mut decoder = gif::DecodeOptions::new().read_info(&bytes[..]).unwrap();
    let mut frames = Vec::new();
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        frames.push((frame.delay, frame.buffer.clone()));
    }
    assert_eq!(frames.len(), 4);
    assert!(frames[3].0 > frames[0].0 && frames.windows(2).all(|pair| pair[0].1 != pair[1].1));
    let reader = png::Decoder::new(std::io::Cursor::new(movie("a.png"))).read_info().unwrap();
    assert_eq!(reader.info().animation_control().unwrap().num_frames, 4);
    let page = String::from_utf8(movie("a.html")).unwrap();
    let part = |name: &str| page.split_once(&format!("id=\"{name}\">")).unwrap().1.split_once("</script>").unwrap().0;
    let data: serde_json::Value = serde_json::from_str(part("furrow-data")).unwrap();
    assert_eq!((data["rows"].as_array().unwrap().len(), data["frames"].as_array().unwrap().len()), (4, 4));
    assert!(part("film-frames").len() > 10_000 && page.len() < 200_000, "{}", page.len());
    let text = String::from_utf8(movie("a.svg")).unwrap();
    assert_eq!(text.matches("<animate ").count(), 4);
    assert!(text.contains("asymmetric, χ = 0.13") && text.matches("display=\"inline\"").count() == 1);
}
