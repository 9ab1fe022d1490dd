use std::fs;

use proptest::{collection::vec, option, prelude::*};
use rusqlite::Connection;
use tempfile::TempDir;

use super::{maintenance, sqlite::FILE, *};
use crate::batch::{Key, SOLVER_VERSION, fake};
use furrow_mechanics::critical::Archive;
use furrow_mechanics::division::{Division, Ending, SecondNeck};

fn r0(number: usize) -> f64 {
    1.0 + number as f64 / 16.0
}

fn commit(store: &Store, number: usize) {
    let input = fake::input(r0(number));
    store.commit(&Key::new(&input), &input, &fake::divide(&input));
}

fn get(store: &Store, number: usize) -> Option<Division> {
    store.get(&Key::new(&fake::input(r0(number))))
}

impl Store {
    fn radius(&self, search: &str) -> Option<String> {
        Archive::get(self, search)
    }
}

fn store(cache: &TempDir) -> Store {
    Store::open(cache.path()).unwrap()
}

/// Checks that a store has given up reading or writing, and returns its only warning.
fn gave_up(store: &Store, what: &str) -> String {
    let warnings = store.take_warnings();
    assert!(matches!(&warnings[..], [StoreWarning::GivenUp { access, .. }] if *access == what), "{warnings:?}");
    // The store warns once, but keeps the reason.
    assert_eq!((store.take_warnings(), store.given_up().as_ref()), (vec![], warnings.first()));
    warnings[0].to_string()
}

/// A cache with the entries 0 to `n` − 1.
fn filled(n: usize) -> TempDir {
    let cache = tempfile::tempdir().unwrap();
    let store = store(&cache);
    (0..n).for_each(|number| commit(&store, number));
    assert_eq!(store.take_warnings(), []);
    cache
}

fn assert_holds(store: &Store, numbers: impl IntoIterator<Item = usize>) {
    for number in numbers {
        assert_eq!(get(store, number), Some(fake::divide(&fake::input(r0(number)))), "entry {number}");
    }
}

fn sql<T: rusqlite::types::FromSql>(cache: &TempDir, query: &str) -> T {
    let connection = Connection::open(cache.path().join(FILE)).unwrap();
    connection.query_row(query, (), |row| row.get(0)).unwrap()
}

fn counts(cache: &TempDir) -> [usize; 3] {
    let report = maintenance::verify(cache.path()).unwrap();
    [report.entries, report.other_versions, report.corrupt]
}

fn number() -> impl Strategy<Value = f64> {
    prop_oneof![20 => 0.0..1.0_f64, 2 => Just(-0.0), 1 => any::<u64>().prop_map(f64::from_bits)]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]
    #[test]
    fn a_division_comes_back_bit_for_bit(
        outcome in 0..3_usize,
        reals in vec(number(), 6),
        maybe in vec(option::of(number()), 4),
        counts in any::<[u32; 5]>().prop_map(|counts| counts.map(|count| count as usize)),
    ) {
        let [steps, rejected, iterations, factorisations, remeshings] = counts;
        let division = Division {
            ending: match outcome {
                2 => Ending::Arrested { growth_rate: maybe[0] },
                _ => Ending::Divided {
                    symmetric: outcome == 0,
                    chi_signed: reals[0],
                    u_furrow: reals[1],
                    daughters: [reals[2], reals[3]],
                },
            },
            t_end: reals[4],
            slow_growth_rate: maybe[1],
            phi: maybe[2],
            neck_offset: maybe[3],
            second_neck: maybe[0].map(|radius| SecondNeck { u: reals[1], radius, share: reals[0] }),
            volume_drift: reals[5],
            work: furrow_bvp::Work { steps, rejected, iterations, factorisations, remeshings },
        };
        let cache = tempfile::tempdir().unwrap();
        let input = fake::input(2.0);
        let key = Key::new(&input);
        store(&cache).commit(&key, &input, &division);
        let read = store(&cache).get(&key);
        // Numbers out of range, NaN included, are not kept.
        prop_assert_eq!(read.is_some(), row::in_range(&division));
        // `{:?}` tells −0 from 0 and prints enough digits to tell any two numbers apart.
        if let Some(read) = read {
            prop_assert_eq!(format!("{read:?}"), format!("{division:?}"));
        }
    }
}

#[test]
fn rows_can_be_read_by_others() {
    let cache = filled(100);
    assert_holds(&store(&cache), 0..100);
    assert_eq!(counts(&cache), [100, 0, 0]);
    assert_eq!(sql::<u32>(&cache, "SELECT count(*) FROM division WHERE cue = 'none' AND r0 >= 2"), 84);
    let chi: f64 = sql(&cache, "SELECT chi FROM division WHERE r0 = 2");
    assert_eq!(Some(chi), fake::divide(&fake::input(2.0)).chi());
    assert_eq!(sql::<u32>(&cache, "SELECT DISTINCT solver FROM division"), SOLVER_VERSION);
}

#[test]
fn a_changed_value_costs_its_own_row_and_is_mended_by_solving_again() {
    for change in
        ["chi = 0.25", "t_end = NULL", "cue = 'kappa'", "steps = 7", "r0 = 2.5", "checksum = 1", "outcome = x'00'"]
    {
        let cache = filled(5);
        let connection = Connection::open(cache.path().join(FILE)).unwrap();
        connection.execute(&format!("UPDATE division SET {change} WHERE r0 = {}", r0(3)), ()).unwrap();
        drop(connection);
        assert_eq!(counts(&cache), [4, 0, 1], "{change}");

        let store = store(&cache);
        assert_eq!(get(&store, 3), None, "{change}");
        assert_holds(&store, [0, 1, 2, 4]);
        let warnings = store.take_warnings();
        assert_eq!(warnings, [StoreWarning::Damaged { entries: 1, file: cache.path().join(FILE) }]);
        assert!(warnings[0].to_string().starts_with("1 damaged entry in "), "{}", warnings[0]);
        assert_eq!((store.damaged(), store.take_warnings().len()), (1, 0));
        commit(&store, 3);
        assert_holds(&store, 0..5);
        assert_eq!(counts(&cache), [5, 0, 0], "{change}");
    }
}

/// Any byte may flip: rows are still read as they were written, a run continues, and the file can be repaired.
#[test]
fn a_flipped_byte_is_never_used() {
    let mut random = 0x9e37_79b9_7f4a_7c15_u64;
    for round in 0..30 {
        let cache = filled(40);
        let file = cache.path().join(FILE);
        let mut bytes = fs::read(&file).unwrap();
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        // The header and the schema among the places.
        let place = (random >> 33) as usize % if round < 10 { 1000 } else { bytes.len() };
        bytes[place] ^= 0x10 | (random >> 20) as u8 & 0x0f;
        fs::write(&file, bytes).unwrap();

        let store = store(&cache);
        for number in 0..40 {
            let found = get(&store, number);
            let input = fake::input(r0(number));
            assert!(found.is_none_or(|found| found == fake::divide(&input)), "byte {place}, entry {number}");
            commit(&store, number);
        }
        assert!(store.take_warnings().len() <= 3);
        drop(store);
        match maintenance::repair(cache.path()) {
            Ok(_) => {
                let mended = self::store(&cache);
                (0..40).for_each(|number| commit(&mended, number));
                assert_holds(&mended, 0..40);
                assert_eq!((counts(&cache), mended.take_warnings().len()), ([40, 0, 0], 0), "byte {place}");
            }
            // The flipped byte is in the version of the schema.
            Err(error) => assert!(matches!(error, StoreError::Newer { .. }) && place < 100, "byte {place}: {error}"),
        }
    }
}

#[test]
fn a_file_that_is_no_database_is_a_warning_and_can_be_repaired() {
    let cache = tempfile::tempdir().unwrap();
    fs::write(cache.path().join(FILE), "this is no database, and long enough to be taken for one".repeat(100)).unwrap();
    let store = store(&cache);
    assert_eq!(get(&store, 1), None);
    commit(&store, 1);
    assert!(gave_up(&store, "read").contains("verify --repair"));
    drop(store);
    assert_eq!(maintenance::repair(cache.path()).unwrap().corrupt, 1);
    let store = self::store(&cache);
    commit(&store, 1);
    assert_eq!((counts(&cache), store.take_warnings().len()), ([1, 0, 0], 0));
}

#[test]
fn rows_of_another_solver_are_neither_used_nor_touched() {
    let cache = filled(3);
    let newer = Store::of_solver(cache.path(), SOLVER_VERSION + 1).unwrap();
    assert_eq!(get(&newer, 0), None);
    commit(&newer, 0);
    assert_holds(&newer, [0]);
    assert_eq!(counts(&cache), [3, 1, 0]);
    assert_holds(&store(&cache), 0..3);
}

/// The rows of an older table are kept under another name; the new one is used at once.
#[test]
fn a_table_of_an_older_schema_is_set_aside() {
    let cache = filled(3);
    let older = "ALTER TABLE division DROP COLUMN phi; PRAGMA user_version = 2";
    Connection::open(cache.path().join(FILE)).unwrap().execute_batch(older).unwrap();
    let store = store(&cache);
    assert_eq!(get(&store, 0), None);
    commit(&store, 5);
    assert_holds(&store, [5]);
    let count = |table: &str| sql::<i64>(&cache, &format!("SELECT count(*) FROM {table}"));
    assert_eq!((count("division_2"), count("division")), (3, 1));
    assert_eq!(store.take_warnings(), []);
}

#[test]
fn a_file_with_a_newer_schema_is_left_alone() {
    let cache = filled(3);
    let file = cache.path().join(FILE);
    Connection::open(&file).unwrap().execute_batch("PRAGMA user_version = 7").unwrap();
    let before = fs::read(&file).unwrap();
    let store = store(&cache);
    assert_eq!(get(&store, 0), None);
    commit(&store, 5);
    assert!(gave_up(&store, "read").contains("newer version of furrow (schema 7, known here: 6)"));
    assert!(maintenance::clear(cache.path()).is_err());
    drop(store);
    assert_eq!(fs::read(&file).unwrap(), before);
}

#[test]
fn stores_on_one_file_see_each_other_and_may_be_cleared_under_way() {
    let cache = tempfile::tempdir().unwrap();
    let (left, right) = (store(&cache), store(&cache));
    assert_eq!(get(&right, 1), None);
    assert!(!cache.path().join(FILE).exists(), "nothing is created by looking");
    commit(&left, 1);
    commit(&right, 2);
    commit(&right, 1);
    assert_holds(&left, [1, 2]);
    assert_holds(&right, [1, 2]);

    let stranger = cache.path().join("boundary.ron");
    fs::write(&stranger, "kept").unwrap();
    assert_eq!(maintenance::clear(cache.path()).unwrap().entries, 2);
    assert_eq!((counts(&cache), get(&left, 1)), ([0; 3], None));
    commit(&left, 3);
    assert_holds(&right, [3]);
    assert_eq!(fs::read_to_string(&stranger).unwrap(), "kept");
    assert_eq!((left.take_warnings(), right.take_warnings()), (vec![], vec![]));
}

#[test]
fn many_threads_share_a_store() {
    let cache = tempfile::tempdir().unwrap();
    let store = store(&cache);
    std::thread::scope(|scope| {
        for thread in 0..8 {
            let store = &store;
            scope.spawn(move || (thread * 20..thread * 20 + 20).for_each(|number| commit(store, number)));
        }
    });
    assert_holds(&store, 0..160);
    assert_eq!(store.take_warnings(), []);
}

#[test]
fn a_folder_that_cannot_hold_a_store_is_named_or_a_warning() {
    let cache = tempfile::tempdir().unwrap();
    let file = cache.path().join("file");
    fs::write(&file, "").unwrap();
    let text = Store::open(&file).unwrap_err().to_string();
    assert_eq!(text, format!("the cache {} is not a folder", file.display()));

    // Where its folder should be made, there is a file.
    let store = Store::open(&file.join("inside")).unwrap();
    (1..4).for_each(|number| commit(&store, number));
    assert!(gave_up(&store, "write").ends_with("going on without storing"));
}

/// Everything is allowed to root, for whom the file is then written.
#[cfg(unix)]
#[test]
fn a_read_only_folder_is_read() {
    use std::os::unix::fs::PermissionsExt;
    let cache = filled(3);
    let set = |path: &std::path::Path, mode| fs::set_permissions(path, fs::Permissions::from_mode(mode)).unwrap();
    set(&cache.path().join(FILE), 0o444);
    set(cache.path(), 0o555);
    let store = store(&cache);
    assert_holds(&store, 0..3);
    commit(&store, 4);
    if get(&store, 4).is_none() {
        gave_up(&store, "write");
    }
    assert_holds(&store, 0..3);
    set(cache.path(), 0o755);
}

#[test]
fn critical_radii_are_kept_until_the_cache_is_cleared() {
    let cache = tempfile::tempdir().unwrap();
    assert_eq!(store(&cache).radius("a"), None);
    store(&cache).put("a", "1.5");
    store(&cache).put("b", "2.5");
    assert_eq!(["a", "b", "c"].map(|of| store(&cache).radius(of)), [Some("1.5".into()), Some("2.5".into()), None]);
    let other = Store::of_solver(cache.path(), SOLVER_VERSION + 1).unwrap();
    assert_eq!(other.radius("a"), None);
    // A damaged one is searched for again.
    let connection = Connection::open(cache.path().join(FILE)).unwrap();
    connection.execute("UPDATE radius SET found = '9.5' WHERE search = 'a'", ()).unwrap();
    drop(connection);
    assert_eq!(["a", "b"].map(|of| store(&cache).radius(of)), [None, Some("2.5".into())]);
    maintenance::clear(cache.path()).unwrap();
    assert_eq!(store(&cache).radius("b"), None);
    assert_eq!(counts(&cache), [0; 3]);
}
