//! The document as the text that a host keeps.
//!
//! Hosts do things to text: Nuke runs what stands in brackets as TCL, others break lines or mangle quotes. So the document's
//! JSON is kept in letters, digits, `-` and `_` alone (base64url, RFC 4648 §5, without padding) behind a name with the version
//! of this form. Plain JSON, as a script may set it, is taken too.

use std::borrow::Cow;

/// What a text of this form begins with.
const PREFIX: &str = "rototoon1_";
const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";

/// The text that is kept of a document's JSON.
pub fn encode(json: &str) -> String {
    let mut text = String::with_capacity(PREFIX.len() + json.len().div_ceil(3) * 4);
    text.push_str(PREFIX);
    for bytes in json.as_bytes().chunks(3) {
        let bits = bytes.iter().fold(0u32, |bits, &byte| bits << 8 | u32::from(byte)) << (8 * (3 - bytes.len()));
        for k in 0..=bytes.len() {
            text.push(char::from(LETTERS[(bits >> (18 - 6 * k)) as usize & 63]));
        }
    }
    text
}

/// The JSON of a text that was kept; an error says what is wrong with it.
pub fn decode(text: &str) -> Result<Cow<'_, str>, String> {
    let text = text.trim();
    let Some(code) = text.strip_prefix(PREFIX) else {
        if text.starts_with("rototoon") {
            return Err(format!(
                "a newer Rototoon kept the composition's document, expected one that begins with {PREFIX}"
            ));
        }
        return Ok(Cow::Borrowed(text));
    };
    let mut bytes = Vec::with_capacity(code.len() / 4 * 3 + 2);
    let mut values = [None; 256];
    LETTERS.iter().zip(0u32..).for_each(|(letter, value)| values[usize::from(*letter)] = Some(value));
    let (mut bits, mut count) = (0u32, 0);
    for (at, letter) in code.bytes().enumerate() {
        let value = values[usize::from(letter)];
        let value = value.ok_or_else(|| format!("the composition's document is damaged at letter {at}"))?;
        bits = bits << 6 | value;
        count += 6;
        if count >= 8 {
            count -= 8;
            bytes.push((bits >> count) as u8);
        }
    }
    String::from_utf8(bytes).map(Cow::Owned).map_err(|_| "the composition's document is damaged: it is no text".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_kept_comes_back_whatever_its_length() {
        for json in ["", "{", "{}", "{\"ü\": [1, 2.5]}\n", "größer als 3 → 4"] {
            let text = encode(json);
            assert!(text.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'-' || b == b'_'), "{text}");
            assert_eq!(decode(&text).unwrap(), json);
        }
        assert_eq!(encode("Man"), "rototoon1_TWFu");
        assert_eq!(encode("Ma"), "rototoon1_TWE");
    }

    #[test]
    fn plain_json_is_taken_and_damage_is_told() {
        assert_eq!(decode(" {\"a\": 1} ").unwrap(), "{\"a\": 1}");
        assert!(decode("rototoon1_TW[u").unwrap_err().contains("letter 2"));
        assert!(decode("rototoon1___8").unwrap_err().contains("no text"));
        assert!(decode("rototoon2_TWFu").unwrap_err().contains("newer"));
    }
}
