// SPDX-License-Identifier: MIT OR Apache-2.0
//! Values that change with time: keys, and what lies between them. Knows no text and no scene.

use super::values::Section;
use crate::capi::fields::{Field, MOST_NUMBERS, Value};
use arrayvec::ArrayVec;

/// The way from a key to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Curve {
    /// The key's value until the next key.
    Hold,
    /// In even steps.
    Linear,
    /// A cubic whose slope at a key is that from the key before to the key after (Catmull and Rom 1974, in the form for
    /// uneven times): smooth through all keys.
    CatmullRom,
    /// At rest at both keys: 3 s^2 - 2 s^3.
    Ease,
}

impl Curve {
    /// Its names in text.
    pub const WORDS: [(&'static str, Self); 4] =
        [("hold", Self::Hold), ("linear", Self::Linear), ("catmull_rom", Self::CatmullRom), ("ease", Self::Ease)];

    pub fn word(self) -> &'static str {
        Self::WORDS.iter().find(|(_, curve)| *curve == self).map_or("hold", |(word, _)| word)
    }
}

/// A value at a time, in seconds, and the curve from there to the next key.
#[derive(Clone, Debug, PartialEq)]
pub struct Key {
    pub time: f64,
    pub value: Value,
    pub curve: Curve,
}

/// A field's keys, one at least, in the order of their times. Of two with the same time the first ends what comes
/// before, the second begins what comes after: a cut.
#[derive(Clone, Debug)]
pub struct Track {
    pub section: Section,
    pub field: &'static Field,
    pub keys: Vec<Key>,
}

impl Track {
    /// The value at a time: before the first key the first one's, after the last key the last one's.
    pub fn value_at(&self, seconds: f64) -> Option<Value> {
        let after = self.keys.partition_point(|key| key.time <= seconds);
        let Some(first) = after.checked_sub(1) else { return self.keys.first().map(|key| key.value.clone()) };
        let from = self.keys.get(first)?;
        let Some(to) = self.keys.get(after) else { return Some(from.value.clone()) };
        let (Value::Numbers(a), Value::Numbers(b)) = (&from.value, &to.value) else { return Some(from.value.clone()) };
        let length = to.time - from.time;
        let share = (seconds - from.time) / length;
        // A unit quaternion and its negative are one rotation: the nearer of the two is the shorter way.
        let is_rotation = a.len() == MOST_NUMBERS;
        let nearer = |one: &[f64], other: &[f64]| {
            let is_far = is_rotation && one.iter().zip(other).map(|(a, b)| a * b).sum::<f64>() < 0.0;
            if is_far { -1.0 } else { 1.0 }
        };
        let sign = nearer(a, b);
        let beside = |index: Option<usize>, time, next: &[f64], sign: f64| {
            let (beside, numbers) = self.neighbour(index?, time)?;
            Some((beside, numbers, sign * nearer(next, numbers)))
        };
        let before = beside(first.checked_sub(1), from.time, a, 1.0);
        let behind = beside(Some(after + 1), to.time, b, sign).filter(|_| to.curve != Curve::Hold);
        let part = |of: &[f64], i: usize| of.get(i).copied().unwrap_or_default();
        let between = |i: usize, a: f64, b: f64| match from.curve {
            Curve::Hold => a,
            Curve::Linear => a + (b - a) * share,
            Curve::Ease => a + (b - a) * share * share * (3.0 - 2.0 * share),
            Curve::CatmullRom => {
                let straight = (b - a) / length;
                let begin = before.map_or(straight, |(t, of, sign)| (b - sign * part(of, i)) / (to.time - t));
                let end = behind.map_or(straight, |(t, of, sign)| (sign * part(of, i) - a) / (t - from.time));
                hermite(share, a, b, begin * length, end * length)
            }
        };
        let mut value: ArrayVec<f64, MOST_NUMBERS> =
            a.iter().zip(b).enumerate().map(|(i, (a, b))| between(i, *a, sign * b)).collect();
        if is_rotation {
            let length = value.iter().map(|part| part * part).sum::<f64>().sqrt();
            value.iter_mut().for_each(|part| *part /= length);
        }
        Some(Value::Numbers(value))
    }

    /// Time and numbers of a key beside one at `time`, unless a cut or a held value lies between.
    fn neighbour(&self, index: usize, time: f64) -> Option<(f64, &[f64])> {
        let key = self.keys.get(index)?;
        let Value::Numbers(numbers) = &key.value else { return None };
        let holds = key.time < time && key.curve == Curve::Hold;
        (key.time != time && !holds).then_some((key.time, numbers.as_slice()))
    }
}

/// The cubic from a to b with slopes m and n at its ends, over s from 0 to 1.
fn hermite(s: f64, a: f64, b: f64, m: f64, n: f64) -> f64 {
    let (left, t) = (1.0 - s, s * s);
    a * (1.0 + 2.0 * s) * left * left + m * s * left * left + b * t * (3.0 - 2.0 * s) - n * t * left
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capi::fields::Kind;

    static FIELD: Field = Field { name: "x", offset: 0, kind: Kind::Numbers(1) };

    fn track(keys: &[(f64, f64, Curve)]) -> Track {
        let key = |&(time, value, curve): &(f64, f64, Curve)| Key {
            time,
            value: Value::Numbers(std::iter::once(value).collect()),
            curve,
        };
        Track { section: Section::Moment, field: &FIELD, keys: keys.iter().map(key).collect() }
    }

    fn at(track: &Track, seconds: f64) -> f64 {
        match track.value_at(seconds) {
            Some(Value::Numbers(numbers)) => numbers[0],
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn every_curve_goes_through_its_keys_and_stays_beyond() {
        for curve in [Curve::Hold, Curve::Linear, Curve::CatmullRom, Curve::Ease] {
            let track = track(&[(1.0, 3.0, curve), (2.0, 5.0, curve), (4.0, -7.0, curve)]);
            let values = [0.0, 1.0, 2.0, 4.0, 9.0].map(|time| at(&track, time));
            assert_eq!(values, [3.0, 3.0, 5.0, -7.0, -7.0], "{curve:?}");
        }
    }

    #[test]
    fn between_keys_each_curve_is_what_it_says() {
        let two = |curve| track(&[(0.0, 0.0, curve), (2.0, 10.0, curve)]);
        let at_half = |curve| [0.5, 1.0, 1.5].map(|time| at(&two(curve), time));
        assert_eq!(at_half(Curve::Hold), [0.0; 3]);
        assert_eq!(at_half(Curve::Linear), [2.5, 5.0, 7.5]);
        assert_eq!(at_half(Curve::Ease), [1.5625, 5.0, 8.4375]);
        // Where all keys lie on a line, so do all values, at uneven times too.
        let line = track(&[0.0, 1.0, 1.5, 4.0].map(|time| (time, 3.0 * time + 1.0, Curve::CatmullRom)));
        for time in [0.2, 1.1, 1.4, 2.0, 3.9] {
            assert!((at(&line, time) - (3.0 * time + 1.0)).abs() < 1e-14, "{time}");
        }
        // The slope is the same on both sides of a key.
        let bent = track(&[(0.0, 0.0), (1.0, 2.0), (3.0, 1.0), (4.0, 5.0)].map(|(t, x)| (t, x, Curve::CatmullRom)));
        for key in [1.0, 3.0] {
            let slope = |side: f64| (at(&bent, key + side * 1e-6) - at(&bent, key)) / (side * 1e-6);
            assert!((slope(1.0) - slope(-1.0)).abs() < 1e-4, "{} {}", slope(1.0), slope(-1.0));
        }
    }

    #[test]
    fn two_keys_of_one_time_are_a_cut() {
        use Curve::{CatmullRom, Linear};
        let cut = track(&[(0.0, 0.0, Linear), (1.0, 1.0, Linear), (1.0, 8.0, CatmullRom), (2.0, 9.0, CatmullRom)]);
        assert_eq!([0.5, 1.0, 1.5].map(|time| at(&cut, time)), [0.5, 8.0, 8.5]);
    }

    /// Turns by 100 degrees from key to key, whose quaternions are given with any sign: the speed has no dips at keys.
    #[test]
    fn a_rotation_turns_smoothly_through_its_keys() {
        let key = |time: f64| {
            let half = (50.0 * time).to_radians();
            let sign = if time == 2.0 { -1.0 } else { 1.0 };
            let value = [0.0, 0.0, sign * half.sin(), sign * half.cos()];
            Key { time, value: Value::Numbers(value.into_iter().collect()), curve: Curve::CatmullRom }
        };
        let keys = [0.0, 1.0, 2.0, 3.0].map(key).to_vec();
        let turn = Track { section: Section::Sky, field: &FIELD, keys };
        let angle = |time: f64| match turn.value_at(time) {
            Some(Value::Numbers(q)) => 2.0 * q[2].atan2(q[3]),
            other => panic!("{other:?}"),
        };
        let speed = |time: f64| {
            let difference = angle(time + 1e-5) - angle(time - 1e-5);
            let turned = difference - (difference / std::f64::consts::TAU).round() * std::f64::consts::TAU;
            (turned / 2e-5).to_degrees()
        };
        for time in [0.95, 1.05, 1.5, 1.95, 2.05] {
            assert!((75.0..130.0).contains(&speed(time)), "{time}: {}", speed(time));
        }
        let jump = speed(1.0 - 1e-4) - speed(1.0 + 1e-4);
        assert!(jump.abs() < 1.0, "{jump}");
    }

    #[test]
    fn a_rotation_stays_one_and_turns_the_shorter_way() {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let key = |time, [x, y, z, w]: [f64; 4]| Key {
            time,
            value: Value::Numbers([x, y, z, w].into_iter().collect()),
            curve: Curve::Linear,
        };
        let keys = vec![key(0.0, [0.0, 0.0, 0.0, 1.0]), key(1.0, [0.0, 0.0, -half, -half])];
        let turn = Track { section: Section::Sky, field: &FIELD, keys };
        let Some(Value::Numbers(middle)) = turn.value_at(0.5) else { panic!() };
        let eighth = std::f64::consts::PI / 8.0;
        assert!((middle[2] - eighth.sin()).abs() < 1e-12 && (middle[3] - eighth.cos()).abs() < 1e-12, "{middle:?}");
    }
}
