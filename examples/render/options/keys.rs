//! Settings by their keys: which technique is meant where only some of its settings are given.

use antumbra::Technique;

/// The share of letters that agree from which on one key is offered in the place of another: two of three.
const ALIKE: f64 = 0.6;

/// Whether a technique has a setting of this key.
fn has(technique: &Technique, key: &str) -> bool {
    technique.get(key).is_some()
}

/// The techniques that their settings' keys may mean: those with maps. Others are meant by their names alone.
fn meant() -> Vec<Technique> {
    Technique::all().into_iter().filter(|t| has(t, "map")).collect()
}

/// The techniques that have a setting of this key.
fn owners(key: &str) -> Vec<Technique> {
    meant().into_iter().filter(|t| has(t, key)).collect()
}

/// The one technique that has all of these settings; the default one where they are settings of every technique with
/// maps.
///
/// # Errors
/// A sentence where a key is no setting, where no technique has all of them, and where several have.
pub fn technique(keys: &[&str]) -> Result<Technique, String> {
    if let Some(key) = keys.iter().find(|key| owners(key).is_empty()) {
        return Err(format!("no technique has {key}{}", similar(key)));
    }
    let telling: Vec<&str> =
        keys.iter().copied().filter(|key| owners(key).len() < meant().len()).collect();
    let mut with_all = meant();
    with_all.retain(|t| telling.iter().all(|key| has(t, key)));
    match with_all[..] {
        _ if telling.is_empty() => Ok(Technique::default()),
        [one] => Ok(one),
        [] => {
            let each: Vec<String> =
                telling.iter().map(|key| format!("{key} is of {}", names(&owners(key)))).collect();
            Err(format!("{}; give one technique's", each.join(", ")))
        }
        _ => {
            let names = names(&with_all);
            Err(format!("{} is of {names}; name --technique", telling.join(" with ")))
        }
    }
}

/// The names of some techniques, as in "a, b and c".
fn names(techniques: &[Technique]) -> String {
    let names: Vec<&str> = techniques.iter().map(|t| t.name()).collect();
    match names.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} and {last}", rest.join(", ")),
        _ => names.concat(),
    }
}

/// The setting whose key is nearest to what was written, as a question; nothing where none is near.
fn similar(key: &str) -> String {
    let near = |k: &&str| strsim::normalized_damerau_levenshtein(key, k);
    let all = Technique::all();
    let keys = all.iter().flat_map(|t| t.knobs()).map(|k| k.key);
    let best = keys.max_by(|a, b| near(a).total_cmp(&near(b)));
    best.filter(|k| near(k) > ALIKE).map_or_else(String::new, |k| format!("; {k}?"))
}
