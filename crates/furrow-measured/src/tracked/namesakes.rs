//! Of several cells of one name the one with the most spots comes first: a stray spot does not push out the cell that it is named after.

use std::collections::HashMap;

use super::TrackedCell;

/// The place of each cell, so that the first of several cells of one name has the most spots, or of as many is born first. The others
/// and their descendants come last. `counts` has the numbers of spots.
pub(super) fn order(cells: &[TrackedCell], counts: &[usize]) -> Vec<usize> {
    let mut best: HashMap<&str, usize> = HashMap::new();
    for (cell, TrackedCell { name, .. }) in cells.iter().enumerate().filter(|(_, cell)| !cell.name.is_empty()) {
        let known = best.entry(name).or_insert(cell);
        if counts[cell] > counts[*known] {
            *known = cell;
        }
    }
    let mut is_last = vec![false; cells.len()];
    for (index, cell) in cells.iter().enumerate() {
        // A mother comes before her daughters. Cells that come after their namesake stay where they are.
        is_last[index] = cell.mother.is_some_and(|mother| is_last[mother])
            || best.get(cell.name.as_str()).is_some_and(|best| *best > index);
    }
    let mut by_place: Vec<usize> = (0..cells.len()).collect();
    by_place.sort_by_key(|cell| is_last[*cell]);
    let mut places = vec![0; cells.len()];
    by_place.into_iter().enumerate().for_each(|(place, cell)| places[cell] = place);
    places
}

/// The cells at their new places.
pub(super) fn moved(cells: Vec<TrackedCell>, places: &[usize]) -> Vec<TrackedCell> {
    let mut placed: Vec<(usize, TrackedCell)> =
        cells.into_iter().enumerate().map(|(k, cell)| (places[k], cell)).collect();
    placed.sort_by_key(|(place, _)| *place);
    let renumbered = |(_, mut cell): (usize, TrackedCell)| {
        cell.mother = cell.mother.map(|mother| places[mother]);
        cell.daughters.iter_mut().for_each(|daughter| *daughter = places[*daughter]);
        cell
    };
    placed.into_iter().map(renumbered).collect()
}
