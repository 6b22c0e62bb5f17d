//! How far names are apart in writing, to find what was probably meant.

/// Letters of a name that count. A name of a document may be of any length, and the work grows with its square.
const MOST: usize = 64;

/// Number of letters to insert, remove or replace (Levenshtein).
pub fn letters_apart(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().take(MOST).collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, letter) in a.chars().take(MOST).enumerate() {
        let mut corner = std::mem::replace(&mut row[0], i + 1);
        for (j, other) in b.iter().enumerate() {
            let replaced = corner + usize::from(letter != *other);
            corner = row[j + 1];
            row[j + 1] = replaced.min(corner + 1).min(row[j] + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_that_differ_are_counted() {
        let pairs = [("", ""), ("pins", ""), ("pins", "pin"), ("center", "centers"), ("keys", "kyes"), ("abc", "xabd")];
        assert_eq!(pairs.map(|(a, b)| letters_apart(a, b)), [0, 4, 1, 1, 2, 2]);
        assert_eq!(letters_apart(&"é".repeat(1_000_000), &"e".repeat(1_000_000)), MOST);
    }
}
