//! The options of tracking and snapping: a JSON object of parameter ids, checked against the core's list of parameters.

use crate::status::Failure;
use rototoon::scene::parameters::{ALL, Kind, Parameter, Stage, find};
use serde_json::{Map, Value};

/// Values of the parameters of one stage and of [`Stage::Run`]. A parameter without a value has its default.
#[derive(Debug)]
pub struct Options(Map<String, Value>);

impl Options {
    /// Reads and checks `json`. An empty text gives all defaults.
    pub fn parse(json: &str, stage: Stage) -> Result<Self, Failure> {
        let given: Map<String, Value> = match json {
            "" => Map::new(),
            _ => serde_json::from_str(json).map_err(|error| Failure::Error(format!("options: {error}")))?,
        };
        for (id, value) in &given {
            let known = find(id).filter(|parameter| [stage, Stage::Run].contains(&parameter.stage));
            let parameter = known.ok_or_else(|| unknown(id, stage))?;
            check(parameter, value)?;
        }
        Ok(Self(given))
    }

    /// The value of a choice: its id.
    pub fn choice(&self, id: &str) -> &str {
        let default = match find(id).map(|parameter| parameter.kind) {
            Some(Kind::Choice { default, .. }) => default,
            _ => "",
        };
        self.0.get(id).and_then(Value::as_str).unwrap_or(default)
    }

    /// The value of a number or a whole number.
    pub fn number(&self, id: &str) -> f64 {
        let default = match find(id).map(|parameter| parameter.kind) {
            Some(Kind::Number { default, .. }) => default,
            Some(Kind::Integer { default, .. }) => default as f64,
            _ => 0.0,
        };
        self.0.get(id).and_then(Value::as_f64).unwrap_or(default)
    }
}

fn unknown(id: &str, stage: Stage) -> Failure {
    let known = ALL.iter().filter(|parameter| [stage, Stage::Run].contains(&parameter.stage));
    let known: Vec<&str> = known.map(|parameter| parameter.id).collect();
    Failure::Error(format!("options: found {id:?}, expected one of {}", known.join(", ")))
}

fn check(parameter: &Parameter, value: &Value) -> Result<(), Failure> {
    let (fits, expected) = match parameter.kind {
        Kind::Choice { choices, .. } => {
            let ids: Vec<&str> = choices.iter().map(|choice| choice.id).collect();
            (value.as_str().is_some_and(|text| ids.contains(&text)), format!("one of {}", ids.join(", ")))
        }
        Kind::Integer { min, max, .. } => {
            let fits = value.as_i64().is_some_and(|number| (min..=max).contains(&number));
            (fits, format!("a whole number from {min} to {max}"))
        }
        Kind::Number { min, max, .. } => {
            let fits = value.as_f64().is_some_and(|number| (min..=max).contains(&number));
            (fits, format!("a number from {min} to {max}"))
        }
        Kind::Flag { .. } => (value.is_boolean(), "true or false".into()),
    };
    let id = parameter.id;
    if fits { Ok(()) } else { Err(Failure::Error(format!("options: {id}: found {value}, expected {expected}"))) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn given_values_win_over_defaults() {
        let options = Options::parse(r#"{"corridor_share": 1, "follow": "line", "threads": 3}"#, Stage::Snap).unwrap();
        assert_eq!((options.number("corridor_share"), options.choice("follow")), (1.0, "line"));
        assert_eq!((options.number("threads"), options.number("corridor_least")), (3.0, 4.0));
        assert_eq!(Options::parse("", Stage::Track).unwrap().choice("preset"), "rototoon");
    }

    #[test]
    fn values_that_do_not_fit_are_named() {
        for (json, expected) in [
            (r#"{"follow": "mouse"}"#, r#"options: follow: found "mouse", expected one of auto, edge, line"#),
            (r#"{"threads": 1.5}"#, "options: threads: found 1.5, expected a whole number from 0 to 1024"),
            (r#"{"corridor_share": -1}"#, "options: corridor_share: found -1, expected a number from 0 to 2"),
            (
                r#"{"preset": "rototoon"}"#,
                r#"options: found "preset", expected one of threads, follow, corridor_share"#,
            ),
            ("[]", "options: invalid type"),
            ("{", "options: EOF"),
        ] {
            let message = Options::parse(json, Stage::Snap).unwrap_err().to_string();
            assert!(message.starts_with(expected), "{json}: {message}");
        }
    }
}
