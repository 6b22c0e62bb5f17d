//! Which machine writes, and when: for the report, in which workers of a farm meet.

use std::time::{Duration, SystemTime, UNIX_EPOCH};

/// Seconds of a day.
const DAY: u64 = 86_400;
/// Days from 1 March of the year 0 to 1 January 1970.
const TO_1970: u64 = 719_468;
/// Days of 400 years. After these the calendar repeats.
const ERA: u64 = 146_097;

/// The name that the system gives this machine; empty where it gives none.
pub fn name() -> String {
    #[cfg(unix)]
    {
        rustix::system::uname().nodename().to_string_lossy().into_owned()
    }
    #[cfg(not(unix))]
    std::env::var("COMPUTERNAME").unwrap_or_default()
}

/// A time in UTC by RFC 3339, with milliseconds: `2026-03-01T23:59:59.250Z`. A clock before 1970 counts as 1970.
pub fn time(now: SystemTime) -> String {
    let since = now.duration_since(UNIX_EPOCH).unwrap_or(Duration::ZERO);
    let (days, second) = (since.as_secs() / DAY, since.as_secs() % DAY);
    let [year, month, day] = date(days);
    let (hour, minute, second, millis) = (second / 3600, second / 60 % 60, second % 60, since.subsec_millis());
    format!("{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}.{millis:03}Z")
}

/// Year, month and day, by the days since 1 January 1970. Years are counted from March here, so that a leap day is the last day of its year.
fn date(days: u64) -> [u64; 3] {
    let days = days + TO_1970;
    let (era, day) = (days / ERA, days % ERA);
    let year = (day - day / 1460 + day / 36_524 - day / (ERA - 1)) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    // Months from March on have 31, 30, 31, 30, 31 days, and again: 153 days in five.
    let month = (5 * day + 2) / 153;
    let in_next_year = month >= 10;
    let number = if in_next_year { month - 9 } else { month + 3 };
    [400 * era + year + u64::from(in_next_year), number, day - (153 * month + 2) / 5 + 1]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_those_of_the_calendar() {
        // By `date -u -d @SECONDS`.
        for (millis, expected) in [
            (0, "1970-01-01T00:00:00.000Z"),
            (951_782_399_999, "2000-02-28T23:59:59.999Z"),
            (951_868_799_250, "2000-02-29T23:59:59.250Z"),
            (951_868_800_000, "2000-03-01T00:00:00.000Z"),
            (1_798_761_599_000, "2026-12-31T23:59:59.000Z"),
            (4_107_542_400_000, "2100-03-01T00:00:00.000Z"),
        ] {
            assert_eq!(time(UNIX_EPOCH + Duration::from_millis(millis)), expected);
        }
        assert_eq!(time(UNIX_EPOCH - Duration::from_secs(9)), "1970-01-01T00:00:00.000Z");
    }

    #[test]
    fn this_machine_has_a_name() {
        assert!(!name().is_empty());
    }
}
