//! Help pages: every example runs and every option has a group.

use std::path::Path;

use crate::common::command::{HERE, furrow, keep_what_is_solved};

const COMMANDS: [&str; 19] = [
    "tree",
    "divide",
    "steady",
    "branch",
    "pitchfork",
    "boundary",
    "phase",
    "calibrate",
    "fit",
    "compare counts",
    "compare volumes",
    "compare contour",
    "sweep",
    "merge",
    "export",
    "cache",
    "reproduce",
    "explore",
    "completions",
];

fn help(command: &str) -> String {
    let arguments = command.split_whitespace().chain(["--help"]).collect::<Vec<_>>();
    let output = furrow(HERE, &arguments);
    assert!(output.status.success(), "{command}");
    String::from_utf8(output.stdout).unwrap()
}

/// The examples that a help page ends with.
fn examples(page: &str) -> Vec<Vec<&str>> {
    let (_, examples) = page.split_once("Examples:\n").expect("a page ends with examples");
    let line = |line| str::strip_prefix(line, "  furrow ").expect("nothing but examples").split(' ').collect();
    examples.trim_end().lines().map(line).collect()
}

/// Runs the examples of a page in a folder that has what the repository's has.
fn run_examples(command: &str) {
    run_examples_in(&tempfile::tempdir().unwrap(), command);
}

fn run_examples_in(folder: &tempfile::TempDir, command: &str) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    // Its examples clear the cache.
    if command == "cache" {
        std::fs::create_dir(folder.path().join("cache")).unwrap();
    } else {
        keep_what_is_solved(folder.path());
    }
    for name in ["data/thresholds.ron", "lineages/c_elegans.ron", "studies/cue-position.ron"] {
        let copy = folder.path().join(name);
        std::fs::create_dir(copy.parent().unwrap()).unwrap();
        std::fs::copy(root.join(name), copy).unwrap();
    }
    let page = help(command);
    let examples = examples(&page);
    assert!((2..=4).contains(&examples.len()), "{command} has {} examples", examples.len());
    for example in examples {
        assert!(example.join(" ").starts_with(command), "{example:?}");
        let output = furrow(folder.path(), &example);
        assert!(output.status.success(), "{example:?}: {}", String::from_utf8_lossy(&output.stderr));
        assert!(!output.stdout.is_empty() || example.contains(&"--out"), "{example:?}");
    }
}

#[test]
fn examples_of_quick_commands_run() {
    ["", "divide", "steady", "explore", "cache", "completions"].into_iter().for_each(run_examples);
}

#[test]
fn examples_of_trees_run() {
    run_examples("tree");
}

#[test]
fn examples_of_shapes_run() {
    ["branch", "pitchfork", "phase"].into_iter().for_each(run_examples);
}

#[test]
fn examples_of_boundaries_run() {
    run_examples("boundary");
}

#[test]
fn examples_of_comparisons_run() {
    ["compare counts", "compare volumes"].into_iter().for_each(run_examples);
}

/// Beside frames of a division, an ellipse as a table and as masks.
#[test]
fn examples_of_contours_run_beside_a_division() {
    let folder = tempfile::tempdir().unwrap();
    assert!(furrow(folder.path(), &["divide", "--r0", "2.5", "--frames", "contours"]).status.success());
    let mut outline = "x,y\n".to_owned();
    for k in 0..60 {
        let t = f64::from(k) / 60.0 * std::f64::consts::TAU;
        outline += &format!("{},{}\n", 3.0 * t.cos(), 2.0 * t.sin());
    }
    std::fs::write(folder.path().join("outlines.csv"), outline).unwrap();
    let inside = |k: i32| ((k % 64 - 32) as f64 / 30.0).hypot((k / 64 - 32) as f64 / 20.0) < 1.0;
    let pixels: Vec<u8> = (0..64 * 64).map(|k| if inside(k) { 255 } else { 0 }).collect();
    for name in ["mask_1.png", "mask_2.png"] {
        let file = std::fs::File::create(folder.path().join(name)).unwrap();
        let mut encoder = png::Encoder::new(file, 64, 64);
        encoder.set_color(png::ColorType::Grayscale);
        encoder.write_header().unwrap().write_image_data(&pixels).unwrap();
    }
    run_examples_in(&folder, "compare contour");
}

#[test]
fn examples_of_reproductions_run() {
    run_examples("reproduce");
}

#[test]
fn examples_of_calibrations_run() {
    run_examples("calibrate");
}

/// A fit takes minutes: of its examples the quickest runs, the others are read as far as a file that is not there.
#[test]
fn examples_of_fits_are_understood() {
    let page = help("fit");
    let folder = tempfile::tempdir().unwrap();
    let examples = examples(&page);
    assert!((2..=4).contains(&examples.len()));
    for mut example in examples {
        let quick = example.contains(&"--moves");
        // On a coarse mesh: what is found is held by tests/studies/fit.rs.
        example.extend(if quick { ["--set", "intervals=32"] } else { ["--config", "nowhere.ron"] });
        let output = furrow(folder.path(), &example);
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(
            if quick { output.status.success() } else { said.contains("nowhere.ron: cannot be read") },
            "{example:?}: {said}"
        );
    }
}

#[test]
fn examples_of_sweeps_run() {
    run_examples("sweep");
}

#[test]
fn examples_of_merging_run_where_there_are_parts() {
    let folder = tempfile::tempdir().unwrap();
    let text = r#"Sweep(kind: division, axes: [(parameter: "r0", list: [1.5, 1.55, 1.6])])"#;
    std::fs::write(folder.path().join("sweep.ron"), text).unwrap();
    for (part, shard) in [("part-1", "1/2"), ("part-2", "2/2")] {
        let arguments = ["sweep", "sweep.ron", "--out", part, "--shard", shard, "--no-cache"];
        assert!(furrow(folder.path(), &arguments).status.success());
    }
    run_examples_in(&folder, "merge");
}

#[test]
fn examples_of_exports_run_where_there_is_a_tree() {
    let folder = tempfile::tempdir().unwrap();
    assert!(furrow(folder.path(), &["tree", "--no-cache"]).status.success());
    run_examples_in(&folder, "export");
}

/// "Options" has only clap's --help and --version; all other options are in named groups.
#[test]
fn options_stand_in_groups() {
    for command in COMMANDS.into_iter().chain([""]) {
        let page = help(command);
        for group in ["Parameters:\n", "Numerics:\n", "Output:\n"] {
            assert!(page.contains(group), "{command} has no group {group}");
        }
        let options = page.split("\nOptions:\n").nth(1).unwrap_or("");
        let own =
            options.split("\n\n").flat_map(str::lines).take_while(|line| line.starts_with(' ') || line.is_empty());
        for option in own.filter(|line| line.trim_start().starts_with('-')) {
            assert!(option.contains("--help") || option.contains("--version"), "{command}: {option}");
        }
    }
    for command in ["tree", "divide", "steady", "branch", "pitchfork", "boundary", "phase"] {
        let page = help(command);
        let cell = page.split("\nCell:\n").nth(1).unwrap_or_else(|| panic!("{command} has no group Cell"));
        assert!(
            cell.contains("--r0 <R>") && cell.contains("--epsilon <E>") && cell.contains("--cue <CUE>"),
            "{command}"
        );
    }
    assert!(help("steady").contains("default 25, the preset's"));
}

/// The shell's strength is p0; P0 is a cell.
#[test]
fn the_strength_of_the_shell_is_called_p0() {
    for text in [help("tree"), help("calibrate"), help("boundary")] {
        assert!(!text.contains("P0"), "{text}");
    }
    let refused = furrow(HERE, &["steady", "--r0", "2", "--set", "P0=-1"]);
    assert_eq!(
        String::from_utf8(refused.stderr).unwrap(),
        "furrow: error: --set: physics.p0 = -1: must be a finite number above 0\n"
    );
}
