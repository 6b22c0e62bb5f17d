//! Encodes the document as a text that the host stores.
//!
//! Hosts change texts: Nuke runs text in brackets as TCL, and other hosts break lines or mangle quotes. So the document's
//! JSON is stored with letters, digits, `-` and `_` only (base64url, RFC 4648 §5, without padding), after a prefix with the
//! version of this encoding. Plain JSON, which a script may set, is read too.

use std::borrow::Cow;

/// The prefix of an encoded document.
const PREFIX: &str = "rototoon1_";
const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";

/// Encodes a document's JSON.
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

/// Decodes a stored text into JSON. The error is a message for the user.
pub fn decode(text: &str) -> Result<Cow<'_, str>, String> {
    let text = text.trim();
    let Some(code) = text.strip_prefix(PREFIX) else {
        if text.starts_with("rototoon") {
            return Err(format!("it was stored by a newer Rototoon: expected a text that begins with {PREFIX}"));
        }
        return Ok(Cow::Borrowed(text));
    };
    let mut bytes = Vec::with_capacity(code.len() / 4 * 3 + 2);
    let mut values = [None; 256];
    LETTERS.iter().zip(0u32..).for_each(|(letter, value)| values[usize::from(*letter)] = Some(value));
    let (mut bits, mut count) = (0u32, 0);
    for (at, letter) in code.bytes().enumerate() {
        let value = values[usize::from(letter)];
        let value = value.ok_or_else(|| format!("it is damaged at character {at}"))?;
        bits = bits << 6 | value;
        count += 6;
        if count >= 8 {
            count -= 8;
            bytes.push((bits >> count) as u8);
        }
    }
    String::from_utf8(bytes).map(Cow::Owned).map_err(|_| "it is damaged: it is not UTF-8".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn encoded_texts_of_any_length_are_decoded() {
        for json in ["", "{", "{}", "{\"ü\": [1, 2.5]}\n", "größer als 3 → 4"] {
            let text = encode(json);
            assert!(text.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'-' || b == b'_'), "{text}");
            assert_eq!(decode(&text).unwrap(), json);
        }
        assert_eq!(encode("Man"), "rototoon1_TWFu");
        assert_eq!(encode("Ma"), "rototoon1_TWE");
    }

    #[test]
    fn plain_json_is_read_and_damage_is_reported() {
        assert_eq!(decode(" {\"a\": 1} ").unwrap(), "{\"a\": 1}");
        assert!(decode("rototoon1_TW[u").unwrap_err().contains("character 2"));
        assert!(decode("rototoon1___8").unwrap_err().contains("not UTF-8"));
        assert!(decode("rototoon2_TWFu").unwrap_err().contains("newer"));
    }
}
