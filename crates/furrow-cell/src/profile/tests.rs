use std::f64::consts::PI;

use super::ShellProfile;

/// A table of `rows` places of r = sin θ √(1 + kx), z = 1.5 x + 7 with x = cos θ, blunt where z is large if k > 0.
fn table(rows: usize, k: f64) -> String {
    let place = |i: usize| {
        let (sin, cos) = (i as f64 * PI / (rows - 1) as f64).sin_cos();
        let r = if i == 0 || i + 1 == rows { 0.0 } else { sin * (1.0 + k * cos).sqrt() };
        format!("{},{r}\n", 1.5 * cos + 7.0)
    };
    format!("z (um),r (um)\n{}", (0..rows).map(place).collect::<String>())
}

fn read(text: &str) -> Result<ShellProfile, String> {
    ShellProfile::from_table(text.as_bytes(), "egg", "egg.csv").map_err(|error| error.to_string())
}

#[test]
fn an_ellipse_is_found_exactly_wherever_it_lies_and_whichever_way_it_is_listed() {
    for rows in [9, 13, 60] {
        let profile = read(&table(rows, 0.0)).unwrap();
        assert!((profile.aspect() - 1.5).abs() < 1e-11, "{rows}: {}", profile.aspect());
        assert!(profile.is_mirror_symmetric() && profile.error() < 1e-12);
        let [first, rest @ ..] = profile.factor().series() else { panic!("no terms") };
        assert!((first - 1.0).abs() < 1e-11 && rest.iter().all(|c| c.abs() < 1e-10), "{:?}", profile.factor());
    }
    let mut lines: Vec<String> = table(13, 0.3).lines().map(str::to_owned).collect();
    lines[1..].reverse();
    assert_eq!(read(&lines.join("\n")), read(&table(13, 0.3)));
}

#[test]
fn an_egg_converges_with_the_rows_of_its_table() {
    let fine = read(&table(200, 0.3)).unwrap();
    assert!(!fine.is_mirror_symmetric());
    let distance = |rows: usize| {
        let coarse = read(&table(rows, 0.3)).unwrap();
        let at = |profile: &ShellProfile, k: usize| profile.factor().radius(-1.0 + 0.02 * k as f64);
        (0..=100).map(|k| (at(&coarse, k) - at(&fine, k)).abs()).fold((coarse.aspect() - fine.aspect()).abs(), f64::max)
    };
    let distances = [12, 24, 48].map(distance);
    println!("{distances:?}");
    assert!(distances[0] < 1e-2 && distances[1] < 1e-4 && distances[2] < 1e-7, "{distances:?}");
    // Profile and ellipsoid have the same volume: ½ ∫ ρ³ dμ = 1, by the trapezoidal rule.
    let n = 20_000;
    let sum: f64 = (0..=n)
        .map(|k| {
            fine.factor().radius(-1.0 + 2.0 * k as f64 / n as f64).powi(3) * if [0, n].contains(&k) { 0.5 } else { 1.0 }
        })
        .sum();
    assert!((sum / n as f64 - 1.0).abs() < 1e-8);
    // The wall passes through the points of the table, up to a factor of size.
    let mirrored = fine.mirrored();
    assert_eq!(mirrored.mirrored(), fine);
    assert!((mirrored.factor().radius(0.4) - fine.factor().radius(-0.4)).abs() < 1e-15);
}

#[test]
fn noise_is_smoothed() {
    let text: String = table(120, 0.2)
        .lines()
        .enumerate()
        .map(|(k, line)| match line.split_once(',') {
            Some((z, r)) if (2..120).contains(&k) => {
                format!("{z},{}\n", r.parse::<f64>().unwrap() + 0.004 * (12.9 * (k * k) as f64).sin())
            }
            _ => format!("{line}\n"),
        })
        .collect();
    let (rough, smooth) = (read(&text).unwrap(), read(&table(120, 0.2)).unwrap());
    assert!(rough.factor().series().len() < 12, "{:?}", rough.factor());
    for k in 0..=20 {
        let mu = -1.0 + 0.1 * f64::from(k);
        assert!((rough.factor().radius(mu) - smooth.factor().radius(mu)).abs() < 0.005, "{mu}");
    }
}

/// With terms that count once, six of these tables keep more than six terms.
#[test]
fn few_noisy_tables_keep_terms_that_describe_noise() {
    let mut state = 1_u64;
    let mut uniform = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f64 / (1_u64 << 24) as f64
    };
    let mut noisy = || {
        let row = |(k, line): (usize, &str)| {
            // Close to a normal distribution, with standard deviation 1.
            let noise = (0..12).map(|_| uniform()).sum::<f64>() - 6.0;
            match line.split_once(',').zip((1..42).contains(&k).then_some(())) {
                Some(((z, r), ())) => format!("{z},{}\n", r.parse::<f64>().unwrap() * (1.0 + 0.005 * noise)),
                None => format!("{line}\n"),
            }
        };
        table(41, 0.0).lines().enumerate().map(row).collect::<String>()
    };
    let many = (0..50).filter(|_| read(&noisy()).unwrap().factor().series().len() > 6).count();
    assert!(many <= 2, "{many}");
}

#[test]
fn slopes_are_those_of_the_level_also_in_numbers_with_derivatives() {
    use num_dual::Dual64;

    let profile = read(&table(60, 0.4)).unwrap();
    let level = |place: [f64; 2]| profile.factor().level(place, [0.8, 0.3]).0;
    for place in [[0.3, 1.4], [1.0, 0.2], [0.7, -0.9]] {
        let (_, [by_r, by_z]) = profile.factor().level(place, [0.8, 0.3]);
        let h = 1e-5;
        let slope = |k: usize| {
            let moved = |h: f64| level(std::array::from_fn(|j| place[j] + if j == k { h } else { 0.0 }));
            (moved(h) - moved(-h)) / (4.0 * h)
        };
        assert!((slope(0) - by_r).abs() < 1e-9 && (slope(1) - by_z).abs() < 1e-9);
        let lifted = [Dual64::new(place[0], 0.6), Dual64::new(place[1], -0.8)];
        let (value, [turned, _]) = profile.factor().level(lifted, [0.8, 0.3].map(Dual64::from));
        assert!((value.eps - 2.0 * (0.6 * by_r - 0.8 * by_z)).abs() < 1e-12);
        let moved = |h: f64| profile.factor().level([place[0] + 0.6 * h, place[1] - 0.8 * h], [0.8, 0.3]).1[0];
        assert!((turned.eps - (moved(h) - moved(-h)) / (2.0 * h)).abs() < 1e-8);
    }
}

#[test]
fn tables_that_are_no_shell_are_refused_with_their_line() {
    let with = |line: usize, text: &str| {
        let mut lines: Vec<String> = table(13, 0.0).lines().map(str::to_owned).collect();
        lines[line - 1] = text.to_owned();
        lines.join("\n")
    };
    for (text, expected) in [
        (table(8, 0.0), "egg.csv:9:1: the profile has 8 rows; at least 9 are needed"),
        (with(1, "z (um),r (nm)"), "egg.csv:1:1: z and r must have one unit; z has um, r has nm"),
        (with(1, "x,r"), "egg.csv:1:1: no column \"z\""),
        (with(5, "8,-0.2"), "egg.csv:5:1: r = -0.2: a distance from the axis is 0 or above"),
        (with(5, "8,wide"), "egg.csv:5:1: r (um):"),
        (with(5, "9,0.5"), "egg.csv:5:1: z = 9 after z = 8.299038105676658: z must rise"),
        (with(14, "5.5,0.3"), "egg.csv:14:1: r = 0.3 at z = 5.5: a shell is closed"),
        (with(2, "8.5,0.3"), "egg.csv:2:1: r = 0.3 at z = 8.5: a shell is closed"),
        (with(8, "7,0"), "egg.csv:8:1: r = 0: between the poles r is above 0"),
        (with(8, "7,0.8"), "egg.csv:"),
    ] {
        let error = read(&text).unwrap_err();
        assert!(error.starts_with(expected), "{error}");
    }
    // A bulb behind the neck of a larger one, a gap, and points beside the profile.
    let hidden = "z,r\n5,0\n4.8,1\n4,2\n2,2.5\n0,2\n-0.5,1.2\n-1,0.4\n-2,0.4\n-3,1.5\n-4,1\n-5,0\n";
    assert!(
        read(hidden).unwrap_err().starts_with("egg.csv:10:1: z = -3, r = 1.5 is hidden from z = "),
        "{}",
        read(hidden).unwrap_err()
    );
    let all = table(40, 0.0);
    let gap: String =
        all.lines().enumerate().filter(|(k, _)| !(12..30).contains(k)).map(|(_, l)| format!("{l}\n")).collect();
    let error = read(&gap).unwrap_err();
    assert!(error.starts_with("egg.csv:13:1: ") && error.contains("degrees without a point"), "{error}");
    let error = read(&with(8, "7,0.8")).unwrap_err();
    assert!(error.contains("% off the smooth profile"), "{error}");
}

#[test]
fn profiles_in_json_are_read_back_and_checked() {
    let profile = read(&table(40, 0.2)).unwrap();
    let text = serde_json::to_string(&profile).unwrap();
    assert_eq!(serde_json::from_str::<ShellProfile>(&text).unwrap(), profile);
    for wrong in
        [r#"{"name":"a","aspect":1.5,"error":0,"series":[]}"#, r#"{"name":"a","aspect":1.5,"error":0,"series":[1,2]}"#]
    {
        let error = serde_json::from_str::<ShellProfile>(wrong).unwrap_err().to_string();
        assert!(error.starts_with("shell_profile.series has "), "{error}");
    }
}
