//! Wrong options: status 2 and one sentence, before anything is rendered.

use super::{folder, fs, refuse, report, root, run};

#[test]
fn wrong_options_are_one_sentence() {
    let bunny = root().join("scenes/bunny.glb");
    refuse("key", &bunny, &["--set", "maps=3"], "maps");
    refuse("range", &bunny, &["--set", "map=5000"], "0 to 4096");
    refuse("form", &bunny, &["--set", "map"], "KEY=VALUE");
    refuse("agree", &bunny, &["--set", "accumulate=blend"], "receivers=map");
    refuse("technique", &bunny, &["--technique", "magic"], "soft-shadow-map");
    refuse(
        "served",
        &bunny,
        &["--technique", "hard", "--set", "taps=8"],
        "hard has no such setting",
    );
    refuse("size", &bunny, &["--size", "0x10"], "WxH");
    refuse("repeat", &bunny, &["--repeat", "0"], "--repeat");
    refuse("audit", &bunny, &["--audit", "5"], "--audit: 5 pixels");
    refuse("light", &bunny, &["--light", "sun"], "sun");
    let camera = "no camera is named \"nobody\"; the cameras are \"camera\"";
    refuse("camera", &bunny, &["--camera", "nobody"], camera);
    refuse("role", &bunny, &["--role", "ground=wall"], "wall");
    refuse("node", &bunny, &["--role", "nobody=both"], "nobody");
    refuse("option", &bunny, &["--sides", "two"], "--sides");
    refuse(
        "time",
        &bunny,
        &["--technique", "pcss", "--max-ms", "9"],
        "budget for --technique auto",
    );
    refuse("chosen", &bunny, &["--technique", "auto", "--set", "map=64"], "for auto to choose");
    refuse("tip", &bunny, &["--tecnique", "hard"], "a similar argument exists: '--technique'");
}

#[test]
fn budgets_that_are_mistyped_are_one_sentence() {
    let bunny = root().join("scenes/bunny.glb");
    for (value, wanted) in [
        ("little", "--max-error: little is no error from 0 to 100 %; write 0.02 or 2%"),
        ("2", "2 is 200 %; write 0.02 or 2%"),
        ("1", "1 is 100 %; write 0.01 or 1%"),
        ("100%", "100% is no error"),
        ("-1", "-1 is no error"),
        ("NaN", "NaN is no error"),
        ("inf", "inf is no error"),
        ("0", "no technique can promise an error of 0"),
        ("0%", "no technique can promise an error of 0"),
    ] {
        refuse("error", &bunny, &["--max-error", value], wanted);
    }
    refuse("leave out", &bunny, &["--technique", "pcss", "--max-error", "-1"], "-1 is no error");
    for value in ["0", "-1", "nan", "20s", "soon"] {
        let wanted = format!("--max-ms: {value} is no time above 0; write 20 or 20ms");
        refuse("time", &bunny, &["--max-ms", value], &wanted);
    }
}

#[test]
fn settings_that_name_no_technique_are_one_sentence() {
    let bunny = root().join("scenes/bunny.glb");
    let refuse = |settings: &[&str], wanted: &str| {
        let options: Vec<&str> = settings.iter().flat_map(|s| ["--set", s]).collect();
        refuse("settings", &bunny, &options, wanted);
    };
    refuse(&["mpa=512"], "no technique has mpa; map?");
    refuse(&["map=64", "zzz=1"], "no technique has zzz");
    refuse(&["rays=4", "taps=4"], "rays is of ray-march, taps is of pcss; give one technique's");
    refuse(&["seed=2"], "seed is of many-lights and ray-march; name --technique");
    refuse(&["samples=4"], "samples is of many-lights and linear-light; name --technique");
    refuse(&["map=64", "seed=2", "samples=4", "rays=4"], "give one technique's");
    // Together they are of one alone.
    for (settings, technique) in
        [(["seed=2", "samples=4"], "many-lights"), (["classify=off", "taps=4"], "pcss")]
    {
        let out = folder("one_technique");
        let sets = settings.iter().flat_map(|s| ["--set", s]);
        let options: Vec<&str> = ["--size", "32x32"].into_iter().chain(sets).collect();
        let output = run(&bunny, &out, &options);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        assert_eq!(report(&out)["technique"], technique);
        fs::remove_dir_all(out).unwrap();
    }
}

#[test]
fn a_file_in_the_folders_place_is_found_before_anything_is_rendered() {
    let there = folder("file");
    let file = there.join("results");
    fs::write(&file, b"mine").unwrap();
    for out in [file.clone(), file.join("below")] {
        // The scene is not there either: what is told first was looked for first.
        let output = run(&there.join("nothing.glb"), &out, &[]);
        let line = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{line}");
        let wanted = format!("--out: {} is a file; name a folder\n", file.display());
        assert_eq!(line, wanted);
    }
    assert_eq!(fs::read(&file).unwrap(), b"mine");
    fs::remove_dir_all(there).unwrap();
}
