// SPDX-License-Identifier: MIT OR Apache-2.0
//! Things that are costly to make and large, such as the tables of lenses, kept for those who ask for several by turns.
//! Knows nothing of the things.

/// Things that are kept at most.
pub const MOST: usize = 4;

/// The last things, by key. One is kept, as long as keys only move on: who asks for a new one each time gains nothing
/// from more. Once a key comes back whose thing has been replaced, as those of two eyes do that are shown by turns, one
/// more is kept for it, up to [`MOST`].
pub struct Recent<K, V> {
    /// The last one asked for comes first.
    kept: Vec<(K, V)>,
    /// Keys whose things were replaced lately, the last first.
    replaced: Vec<K>,
}

impl<K, V> Default for Recent<K, V> {
    fn default() -> Self {
        Self { kept: Vec::new(), replaced: Vec::new() }
    }
}

impl<K: PartialEq, V> Recent<K, V> {
    /// Whether the thing of `key` is there; it is then the first.
    pub fn find(&mut self, key: &K) -> bool {
        let Some(place) = self.kept.iter().position(|(kept, _)| kept == key) else { return false };
        self.kept[..=place].rotate_right(1);
        true
    }

    /// Makes room for the thing of `key`, which is not there. The one that goes for it may be made use of.
    pub fn make_room(&mut self, key: &K) -> Option<V> {
        let came_back = self.replaced.iter().position(|replaced| replaced == key);
        if let Some(place) = came_back {
            self.replaced.remove(place);
            if self.kept.len() < MOST {
                return None;
            }
        }
        // A key that comes back replaces the one that was not asked for the longest; others replace the last.
        let goes = if came_back.is_some() { self.kept.pop() } else { self.kept.drain(..1.min(self.kept.len())).next() };
        goes.map(|(key, thing)| {
            self.replaced.insert(0, key);
            self.replaced.truncate(MOST);
            thing
        })
    }

    /// Keeps a thing for which room was made; it is then the first.
    pub fn put(&mut self, key: K, thing: V) {
        self.kept.insert(0, (key, thing));
    }

    /// The thing that was found or put last.
    pub fn first(&self) -> Option<&V> {
        self.kept.first().map(|(_, thing)| thing)
    }

    pub fn first_mut(&mut self) -> Option<&mut V> {
        self.kept.first_mut().map(|(_, thing)| thing)
    }

    /// Drops everything.
    pub fn clear(&mut self) {
        *self = Self::default();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How many are made for the keys, and how many are kept in the end.
    fn made(keys: impl IntoIterator<Item = u32>) -> (usize, usize) {
        let (mut recent, mut made) = (Recent::default(), 0);
        for key in keys {
            if !recent.find(&key) {
                let _ = recent.make_room(&key);
                recent.put(key, key);
                made += 1;
            }
            assert_eq!(recent.first(), Some(&key));
        }
        (made, recent.kept.len())
    }

    #[test]
    fn one_is_kept_of_keys_that_move_on() {
        assert_eq!(made(0..100), (100, 1));
        assert_eq!(made([5; 100]), (1, 1));
        // Two eyes of a head that moves.
        assert_eq!(made((0..50).flat_map(|i| [i, i + 1000])), (100, 1));
    }

    #[test]
    fn all_of_several_by_turns_are_kept() {
        assert_eq!(made((0..100).map(|i| i % 2)), (3, 2));
        assert_eq!(made((0..100).map(|i| i % 4)), (7, 4));
        // More than there is room for.
        assert!(made((0..100).map(|i| i % 6)).1 <= MOST);
        // After a while elsewhere.
        let (count, kept) = made((0..10).map(|i| i % 2).chain(10..60).chain((0..10).map(|i| i % 2 + 100)));
        assert!(count <= 3 + 50 + 4 && kept <= MOST, "{count} {kept}");
    }

    #[test]
    fn what_goes_is_handed_out() {
        let mut recent = Recent::default();
        assert_eq!(recent.make_room(&1), None);
        recent.put(1, "one");
        assert_eq!(recent.make_room(&2), Some("one"));
        recent.put(2, "two");
        assert_eq!(recent.make_room(&1), None);
        recent.put(1, "one again");
        assert!(recent.find(&2) && recent.first() == Some(&"two"));
        recent.clear();
        assert!(!recent.find(&2) && recent.first().is_none());
    }
}
