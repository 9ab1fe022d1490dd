//! Content of the pictures: colours of a cue's signs, names of the poles, titles within the width, complete legends.

use furrow_analysis::BoundaryStudy;
use furrow_cell::{Cell, Cue, Parameter, ShellProfile};
use furrow_figures::drawing::style::{CUE_LOWERS, CUE_RAISES, Colour};
use furrow_figures::drawing::{Canvas, Format};
use furrow_figures::movie::{Movie, MovieFormat, Scene};
use furrow_figures::plot;
use furrow_formats::surface::SurfaceGrid;
use furrow_mechanics::cortex::Wall;
use furrow_mechanics::division::{DivisionInput, Trajectory};

const LONG: &str = "tension:gradient,amplitude=0.3+kappa:band,u0=0.465,omega=0.0577,amplitude=0.1";

fn divided(cue: &str) -> (Cell, Trajectory) {
    let cell = Cell { cue: cue.parse().unwrap(), ..Cell::new(3.0) };
    let film = Trajectory::compute(&DivisionInput::new(cell.clone())).unwrap();
    (cell, film)
}

/// The text of an SVG without the tags of subscripts.
fn plain(svg: &str) -> String {
    let mut parts = svg.split("<tspan").map(|part| part.replace("</tspan>", ""));
    let first = parts.next().unwrap_or_default();
    parts.fold(first, |text, part| text + part.split_once('>').map_or("", |(_, words)| words))
}

/// Horizontal positions of all areas of a colour or a tint of it, at their middle.
fn places(svg: &str, is: impl Fn([f64; 3]) -> bool) -> Vec<f64> {
    let paths = svg.split("<path d=\"M").skip(1);
    let area = |path: &str| {
        let (points, rest) = path.split_once('"')?;
        let fill = rest.split_once("fill=\"#")?.1;
        let channel = |k: usize| u8::from_str_radix(fill.get(2 * k..2 * k + 2)?, 16).ok().map(f64::from);
        let colour = [channel(0)?, channel(1)?, channel(2)?];
        let x = |point: &str| point.split(' ').next()?.parse::<f64>().ok();
        let across: Vec<f64> = points.trim_end_matches('Z').split('L').filter_map(x).collect();
        is(colour).then(|| across.iter().sum::<f64>() / across.len() as f64)
    };
    paths.filter_map(area).collect()
}

/// Whether a colour lies between white and another, nearer to the other.
fn tint_of([r, g, b]: Colour) -> impl Fn([f64; 3]) -> bool {
    let full = [r, g, b].map(f64::from);
    move |colour| {
        let share = (0..3).map(|c| (255.0 - colour[c]) * (255.0 - full[c])).sum::<f64>()
            / (0..3).map(|c| (255.0 - full[c]).powi(2)).sum::<f64>();
        let off = (0..3).map(|c| (colour[c] - 255.0 + share * (255.0 - full[c])).abs()).fold(0.0, f64::max);
        (0.3..=1.01).contains(&share) && off < 1.5
    }
}

#[test]
fn a_gradient_has_a_colour_on_each_side_and_a_legend() {
    let (cell, film) = divided("tension:gradient,amplitude=0.3");
    let svg = plot::division::draw(&cell, &film).svg();
    // The contours lie above the charts; curves there share these colours but are not filled.
    let [raises, lowers] = [CUE_RAISES, CUE_LOWERS].map(|colour| places(&svg, tint_of(colour)));
    assert!(raises.len() > 100 && lowers.len() > 100, "{} {}", raises.len(), lowers.len());
    // In the second of the six contours the left half is lowered and the right half raised.
    let width = (1160.0 - 40.0) / 6.0;
    let within = |all: &[f64]| -> Vec<f64> {
        all.iter().map(|x| (x - 20.0) / width).filter(|x| (1.0..2.0).contains(x)).map(|x| x - 1.5).collect()
    };
    assert!(within(&raises).iter().all(|x| *x > -0.05) && within(&lowers).iter().all(|x| *x < 0.05));
    for word in ["cue raises tension", "cue lowers tension", ">anterior<", ">posterior<"] {
        assert!(svg.contains(word), "no {word}");
    }
}

#[test]
fn the_germline_cue_only_raises_and_no_cue_has_no_legend() {
    let (cell, film) = divided("kappa:band,u0=0.465,omega=0.0577,amplitude=0.1");
    let svg = plot::division::draw(&cell, &film).svg();
    assert!(svg.contains("cue raises rigidity") && !svg.contains("cue lowers"));
    let (cell, film) = divided("none");
    assert!(!plot::division::draw(&cell, &film).svg().contains(">cue "));
}

/// The regulator is produced on one side, so that φ > 0 there; the first of the six contours shows no colour, since φ =
/// 0 at its time.
#[test]
fn a_regulator_is_drawn_on_the_contours_and_over_their_length() {
    let (cell, film) = divided("regulator:step,u0=0.45,omega=0.1,amplitude=1,turnover=5,diffusion=1,friction=1");
    let svg = plain(&plot::division::draw(&cell, &film).svg());
    let above = places(&svg, tint_of(CUE_RAISES));
    let width = (1160.0 - 40.0) / 6.0;
    // The legend lies above the first contour.
    let first = above.iter().filter(|x| (**x - 20.0) / width < 1.0).count();
    assert!(above.len() > 100 && first == 1, "{} {first}", above.len());
    assert!(svg.contains("regulator φ &gt; 0, to ") && svg.contains(">regulator φ<"));
    assert_eq!(svg.matches("t = 0.00 τ").count(), 2);
    // Without a regulator, neither is drawn.
    let (cell, film) = divided("tension:gradient,amplitude=0.3");
    assert!(!plot::division::draw(&cell, &film).svg().contains("regulator"));
}

/// Positions [x, y] of the pixels whose colours meet a condition.
fn pixels(cell: &Cell, film: &Trajectory, share: f64, is: impl Fn([f64; 3]) -> bool) -> Vec<[usize; 2]> {
    let png = Movie { cell, film, frames: 3 }.with_scene(|scene| scene.png(share * scene.times[2], 1.0).unwrap());
    let (pixels, width) = decoded(&png);
    let found = pixels.iter().enumerate().filter(|(_, colour)| is(**colour));
    // Without the title and the legend.
    found.map(|(k, _)| [k % width, k / width]).filter(|[_, y]| (60..400).contains(y)).collect()
}

/// The pixels of a PNG, row by row, and its width.
fn decoded(bytes: &[u8]) -> (Vec<[f64; 3]>, usize) {
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let size = reader.next_frame(&mut pixels).unwrap();
    (pixels.chunks_exact(3).map(|pixel| [0, 1, 2].map(|c| f64::from(pixel[c]))).collect(), size.width as usize)
}

/// The text of a movie of three frames.
fn movie(cell: &Cell, film: &Trajectory) -> String {
    String::from_utf8(Movie { cell, film, frames: 3 }.bytes(MovieFormat::Svg).unwrap()).unwrap()
}

#[test]
fn a_movie_shows_the_regulator() {
    let (cell, film) = divided("regulator:gradient,amplitude=0.9,turnover=10,diffusion=1,activity=0.1");
    let svg = movie(&cell, &film);
    assert_eq!(svg.matches("regulator φ &gt; 0, to ").count(), 3);
    let warm = |share: f64| pixels(&cell, &film, share, |[r, _, b]| r > 1.3 * b).len();
    assert!(warm(0.0) == 0 && warm(1.0) > 2000, "{} {}", warm(0.0), warm(1.0));
}

#[test]
fn the_force_panel_has_the_direction_of_the_contours() {
    let (cell, film) = divided("none");
    let svg = plot::division::draw(&cell, &film).svg();
    // The panel is the last on the right; u = 1 is on its left, below the name of that pole.
    let x_of = |word: &str| -> Vec<f64> {
        let texts = svg.split("<text x=\"").skip(1).filter(|text| text.contains(&format!(">{word}</text>")));
        texts.filter_map(|text| text.split('"').next()?.parse().ok()).collect()
    };
    let last = |word: &str| x_of(word).into_iter().fold(0.0, f64::max);
    // The time axis on the left may have a tick at the same number, so the rightmost one is taken.
    assert!(last("0.8") < last("0.2"), "{} {}", last("0.8"), last("0.2"));
    let anterior = x_of("anterior");
    assert_eq!([anterior.len(), x_of("posterior").len()], [2, 2]);
    assert!(anterior[1] < last("0.8") && last("posterior") > last("0.2"));
}

#[test]
fn a_movie_shows_signs_and_poles() {
    let (cell, film) = divided("tension:gradient,amplitude=0.3");
    let svg = movie(&cell, &film);
    for word in ["cue raises tension", "cue lowers tension", ">anterior<", ">posterior<"] {
        assert_eq!(svg.matches(word).count(), 3, "{word}");
    }
    // The surface at the poles in the last frame: more red than blue where tension is raised, far more blue where it is
    // lowered.
    let warm = pixels(&cell, &film, 1.0, |[r, _, b]| r > 1.3 * b);
    let cold = pixels(&cell, &film, 1.0, |[r, _, b]| b > 2.5 * r);
    let mean = |all: &[[usize; 2]]| all.iter().map(|[x, _]| *x as f64).sum::<f64>() / all.len() as f64;
    assert!(!warm.is_empty() && !cold.is_empty() && mean(&warm) > mean(&cold) + 100.0);
    // Every frame of the text has its surface as a PNG.
    assert_eq!(svg.matches("href=\"data:image/png;base64,iVBORw0KGgo").count(), 3);
    let png = Movie { cell: &cell, film: &film, frames: 2 }.bytes(MovieFormat::Png).unwrap();
    assert!(png.windows(4).any(|name| name == b"pHYs"));
}

/// A body of revolution around z with a furrow of the given depth, on the side of x > 0 alone.
fn notched(depth: f64) -> SurfaceGrid {
    let (rows, columns) = (161, 96);
    let mut grid = SurfaceGrid { rows, columns, ..SurfaceGrid::default() };
    let point = |u: f64, phi: f64| {
        let (sin, cos) = (std::f64::consts::PI * u).sin_cos();
        let r = 2.6 * sin * (1.0 - depth * (-(cos / 0.16).powi(2) - (phi.cos() - 1.0).powi(2)).exp());
        [r * phi.cos(), r * phi.sin(), 3.2 * cos]
    };
    for k in 0..rows * columns {
        let (row, phi) = (k / columns, (k % columns) as f64 / columns as f64 * std::f64::consts::TAU);
        let u = row as f64 / (rows - 1) as f64;
        let along = |from: [f64; 3], to: [f64; 3]| [0, 1, 2].map(|c| to[c] - from[c]);
        let (a, b) =
            (along(point(u - 1e-5, phi), point(u + 1e-5, phi)), along(point(u, phi - 1e-5), point(u, phi + 1e-5)));
        let normal = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
        let size = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
        let end = if row == 0 { 1.0 } else { -1.0 };
        let pole = row == 0 || row == rows - 1;
        grid.points.push(if pole { [0.0, 0.0, 3.2 * end] } else { point(u, phi) });
        grid.normals.push(if pole { [0.0, 0.0, end] } else { normal.map(|x| x / size) });
        grid.values.push(0.0);
    }
    grid
}

/// A scene of a surface alone.
fn scene(shell: Wall, surface: &(dyn Fn(f64) -> SurfaceGrid + Sync)) -> Scene<'_> {
    Scene {
        title: "one side".to_owned(),
        shell,
        times: vec![0.0, 1.0],
        surface,
        forces: &|_| Vec::new(),
        legend: Vec::new(),
        outcome: (2.0, String::new(), [0; 3]),
    }
}

/// A surface without an axis: its furrow is open above, where it is, and the cell is whole below. `FURROW_SCREENSHOTS`
/// keeps the picture.
#[test]
fn a_movie_shows_a_furrow_on_one_side() {
    let width = |depth: f64| {
        let surface = |_: f64| notched(depth);
        let scene = scene(Wall { axes: [2.75, 2.75, 3.3], profile: None }, &surface);
        let png = scene.png(1.0, 1.0).unwrap();
        assert_eq!(png, scene.png(1.0, 1.0).unwrap());
        if let Ok(folder) = std::env::var("FURROW_SCREENSHOTS") {
            std::fs::write(format!("{folder}/notch-{depth}.png"), &png).unwrap();
        }
        let (pixels, width) = decoded(&png);
        // The surface is bluer than the glass and the background.
        let rows = |from: usize, to: usize| {
            let row = |y: usize| &pixels[y * width..][..width];
            (from..to).map(|y| row(y).iter().filter(|[r, _, b]| b - r > 30.0).count()).sum::<usize>() as f64
        };
        [rows(80, 180), rows(300, 400)]
    };
    let ([above, below], [whole, also]) = (width(0.6), width(0.0));
    assert!(above < 0.93 * whole && (below / also - 1.0).abs() < 0.01, "{above} {whole} {below} {also}");
}

/// The pixels of a shell around a small cell, and how many there are in a row.
fn glass(shell: Wall, size: f64) -> (Vec<[f64; 3]>, usize) {
    let surface = |_: f64| {
        let mut grid = notched(0.0);
        grid.points.iter_mut().flatten().for_each(|x| *x *= size);
        grid
    };
    decoded(&scene(shell, &surface).png(0.0, 1.0).unwrap())
}

/// Heights of the glass, one third of its width from either end.
fn heights(shell: Wall) -> [f64; 2] {
    let (pixels, width) = glass(shell, 0.2);
    let tinted = |x: usize, y: &usize| pixels[y * width + x] != [255.0; 3];
    let high = |x: usize| (50..400).filter(|y| tinted(x, y)).max().zip((50..400).find(|y| tinted(x, y)));
    let columns: Vec<(usize, f64)> =
        (85..width - 85).filter_map(|x| high(x).map(|(low, top)| (x, (low - top) as f64))).collect();
    [columns[columns.len() / 3].1, columns[2 * columns.len() / 3].1]
}

/// An egg is drawn as one: as high on the anterior side, on the left, as the profile is wide there, and the ellipsoid alike on both.
#[test]
fn a_movie_shows_the_profile_of_a_shell() {
    let row = |k: usize| {
        let (sin, cos) = (k as f64 * std::f64::consts::PI / 48.0).sin_cos();
        format!("{},{}\n", 3.3 * cos, if k.is_multiple_of(48) { 0.0 } else { 2.75 * sin * (1.0 + 0.5 * cos).sqrt() })
    };
    let table = format!("z,r\n{}", (0..=48).map(row).collect::<String>());
    let egg = ShellProfile::from_table(table.as_bytes(), "egg", "egg.csv").unwrap();
    let axes = [2.75, 2.75, 3.3];
    let [left, right] = heights(Wall { axes, profile: Some(egg.factor().clone()) });
    assert!(left < 0.9 * right, "{left} {right}");
    let [left, right] = heights(Wall { axes, profile: None });
    assert!((left - right).abs() < 3.0, "{left} {right}");
}

/// A shell between plates that face x is drawn less high than a round one, and as long.
#[test]
fn a_movie_shows_a_flattened_shell() {
    let extent = |x: f64| {
        let (pixels, width) = glass(Wall { axes: [x, 2.75, 2.9], profile: None }, 0.3);
        let tinted = |k: usize| pixels[k].map(f64::from) != [255.0; 3];
        // Between the words at the top and at the bottom, and between the names of the poles.
        let inside = (50..400).flat_map(|y| (100..width - 100).map(move |x| (x, y)));
        let seen: Vec<(usize, usize)> = inside.filter(|(x, y)| tinted(y * width + x)).collect();
        let range = |of: fn(&(usize, usize)) -> usize| {
            (seen.iter().map(of).max().unwrap() - seen.iter().map(of).min().unwrap()) as f64
        };
        range(|at| at.1) / range(|at| at.0)
    };
    let (round, flat) = (extent(2.75), extent(0.7 * 2.75));
    // Half the height of the outline is √((x cos 0.3)² + 0.67) as seen from above by 0.3.
    assert!((flat / round - 0.731).abs() < 0.02, "{flat} {round}");
}

/// Whether the title is broken into lines, contains the whole cue, and leaves a margin on the right.
fn title_is_whole(canvas: &Canvas, cue: &str) {
    let svg = canvas.svg();
    let titles: Vec<String> = svg
        .split("<text ")
        .filter(|text| text.contains("font-size=\"20\" text-anchor=\"start\""))
        .filter_map(|text| Some(plain(text.split("</text>").next()?.split_once('>')?.1)))
        .collect();
    assert!(titles.len() > 1 && titles.concat().replace(' ', "").contains(cue), "{titles:?}");
    let (pixels, width) = decoded(&canvas.bytes(Format::Png).unwrap());
    let margin = pixels.chunks_exact(width).take(2 * 18 + 2 * 24 * titles.len()).flat_map(|row| &row[width - 24..]);
    assert!(margin.copied().all(|colour| colour == [255.0; 3]));
}

#[test]
fn long_cues_do_not_cut_a_title() {
    let (cell, film) = divided(LONG);
    let canvas = plot::division::draw(&cell, &film);
    title_is_whole(&canvas, LONG);
    let svg = plain(&canvas.svg());
    assert!(svg.contains("χ = 0.") && svg.contains("strips from the inside: tension, rigidity"));
    assert!(canvas.bytes(Format::Png).unwrap().windows(4).any(|name| name == b"pHYs"));
}

/// The SVG of a boundary's picture, without the tags of subscripts.
fn boundary(cue: &str, parameter: &str) -> String {
    let cell = Cell { cue: cue.parse::<Cue>().unwrap(), ..Cell::new(2.0) };
    let parameter: Parameter = parameter.parse().unwrap();
    let of = BoundaryStudy {
        cell,
        parameter,
        range: [0.1, 0.4],
        pitchforks: Vec::new(),
        folds: Vec::new(),
        cusps: Vec::new(),
        critical: None,
        azimuthal: None,
        bent: None,
        bent_critical: None,
        warnings: Vec::new(),
    };
    plain(&plot::boundary::draw(&of).svg())
}

#[test]
fn an_axis_of_a_cue_has_a_readable_label() {
    let svg = boundary(LONG, "cue.amplitude");
    assert!(svg.contains("amplitude of the cue's first term (tension gradient, κ0/Lh²)") && !svg.contains("cue[0]"));
    // The varied number is not in the title.
    assert!(!svg.contains("amplitude=0.3") && svg.contains("amplitude=0.1"));
    assert!(!svg.contains("pitchfork") && !svg.contains(">fold<"));
}
