// SPDX-License-Identifier: MIT OR Apache-2.0
//! Presets: named looks, each a set of values for disk or volume, sky, film and effects that hosts may then change; and
//! the plain scene, which tests begin with whatever the defaults are. Plain data; the values are documented for hosts
//! in `capi::preset`.

use super::{
    Camera, ColourMap, Disk, DiskReference, EffectStrengths, Effects, EmissionLaw, Film, FlowLaw, Hole, Motion,
    Projection, Quality, Scene, Shape, Sky, ToneMap, View, Volume,
};
use glam::{DQuat, DVec3};

/// A look (`BHR_PRESET_*`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum Preset {
    /// The hole of a film: a turbulent golden disk, glare.
    Cinematic = 0,
    /// The hole that a physicist expects: a smooth disk, no glare, no curve.
    Physical = 1,
    /// The hole of the Event Horizon Telescope's pictures: a ring, blurred, in one colour map.
    Observatory = 2,
    /// For lessons: a grid on the sky, colours by frequency shift alone.
    Teaching = 3,
}

/// The matter that a preset shows (`BHR_PRESET_MATTER_THIN`, `_DEEP`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PresetMatter {
    /// The thin disk.
    Thin,
    /// A volume in its place.
    Deep,
}

impl Preset {
    /// How many there are; their numbers are 0 and up.
    pub const COUNT: usize = 4;

    /// Gives the scene this look: its disk, its film, its effects, and of its sky flags and brightness. Volumes that a
    /// preset has set, and that are still as it did, leave; others stay, as do hole, camera, hot spots, time, quality,
    /// view and the sky's map, orientation and seed.
    pub fn apply(self, scene: &mut Scene) {
        if let Some(own) = scene.preset_volume.take()
            && let Some(place) = scene.volumes.iter().position(|volume| *volume == own)
        {
            scene.volumes.remove(place);
        }
        let (disk, film, effects, flags) = match self {
            Self::Cinematic => (Disk::default(), Film::default(), Effects::ALL, Sky::STARS | Sky::MILKY_WAY),
            Self::Physical => (
                Disk { reference: DiskReference::Median, ..Disk::plain() },
                Film { tone_map: ToneMap::None, exposure_ev: -2.0, ..Film::plain() },
                Effects::ALL,
                Sky::STARS | Sky::MILKY_WAY,
            ),
            Self::Observatory => (
                Disk { outer_radius: 12.0, temperature: 15_000.0, reference: DiskReference::Median, ..Disk::plain() },
                Film {
                    tone_map: ToneMap::None,
                    exposure_ev: -0.5,
                    beam_fwhm: 0.15,
                    colour_map: ColourMap::Afmhot,
                    ..Film::plain()
                },
                Effects::ALL,
                0,
            ),
            Self::Teaching => (
                Disk {
                    outer_radius: 12.0,
                    temperature: 5000.0,
                    // At this brightness the mean of a picture, clipped as displays clip it, differs by less than a
                    // factor of 2.25 from spin to spin.
                    brightness: 0.8,
                    reference: DiskReference::Median,
                    ..Disk::plain()
                },
                Film { tone_map: ToneMap::None, ..Film::plain() },
                Effects::DOPPLER_SHIFT | Effects::GRAVITY_SHIFT,
                Sky::GRID,
            ),
        };
        scene.disk = Some(disk);
        scene.film = film;
        (scene.effects, scene.effect_strengths) = (Effects(effects), EffectStrengths::default());
        scene.sky = Sky { flags, stars_brightness: 1.0, map_brightness: 1.0, ..scene.sky };
    }

    /// Applies the look with its volumes: with `Deep` one in place of the thin disk, else none. Returns `Thin` for a
    /// look that has none with depth.
    pub fn apply_with(self, matter: PresetMatter, scene: &mut Scene) -> PresetMatter {
        self.apply(scene);
        scene.volumes.clear();
        let Some(volume) = self.volume().filter(|_| matter == PresetMatter::Deep) else {
            return PresetMatter::Thin;
        };
        scene.disk = None;
        // There is room: it was cleared.
        let _ = scene.volumes.try_push(volume);
        scene.preset_volume = Some(volume);
        PresetMatter::Deep
    }

    /// Whether the look has matter with depth.
    pub fn has_depth(self) -> bool {
        self.volume().is_some()
    }

    fn volume(self) -> Option<Volume> {
        match self {
            Self::Cinematic => Some(Volume { brightness: 1.4, turbulence: 1.0, ..Volume::plain() }),
            // Temperatures of a thin disk, r^(-3/4) (Shakura and Sunyaev 1973, A&A 24, 337).
            Self::Physical => {
                Some(Volume { temperature: 9000.0, temperature_slope: 0.75, brightness: 7.0, ..Volume::plain() })
            }
            // Models of hot accretion about Sgr A* and M87* (Yuan and Narayan 2014, ARA&A 52, 529): thick, transparent
            // at 230 GHz, slower than Kepler's orbits and falling in.
            Self::Observatory => Some(Volume {
                power_law: true,
                shape: Shape::Torus,
                outer_radius: 20.0,
                radius: 5.0,
                width: 2.0,
                thickness: 0.4,
                absorption: 0.05,
                brightness: 0.6,
                sub_keplerian: 0.8,
                infall: 0.2,
                ..Volume::plain()
            }),
            // Its colours are the frequency shifts of one plane, whose depth would mix them.
            Self::Teaching => None,
        }
    }
}

// Every value is stated here, so that none changes when a default does. Fields that are added later keep their defaults
// until they are stated here.
#[allow(clippy::needless_update, reason = "a field that is added to one of these need not be added here at once")]
mod plain {
    use super::*;

    impl Disk {
        /// Smooth, with a hard edge at 20 M, 6500 K, opaque.
        pub fn plain() -> Self {
            Self {
                retrograde: false,
                inner_radius: 0.0,
                outer_radius: 20.0,
                temperature: 6500.0,
                opacity: 1.0,
                brightness: 1.0,
                turbulence: 0.0,
                seed: 0,
                reference: DiskReference::Hottest,
                edge_softness: 0.0,
                emission_law: EmissionLaw::Isotropic,
                ..Self::default()
            }
        }
    }

    impl Volume {
        /// An even soft disk, from the ISCO to 17 M.
        pub fn plain() -> Self {
            Self {
                retrograde: false,
                power_law: false,
                shape: Shape::Disk,
                flow: FlowLaw::Keplerian,
                inner_radius: 0.0,
                outer_radius: 17.0,
                radius: 8.0,
                width: 2.0,
                thickness: 0.05,
                opening: 0.3,
                slope: 0.7,
                absorption: 3.0,
                temperature: 4800.0,
                temperature_slope: 0.35,
                spectral_index: 1.0,
                tint: [1.0; 3],
                brightness: 1.0,
                sub_keplerian: 1.0,
                infall: 0.0,
                angular_momentum: 1.0,
                speed: 0.9,
                turbulence: 0.0,
                clumping: 1.8,
                heating: 0.15,
                seed: 0,
                ..Self::default()
            }
        }
    }

    impl Film {
        /// ACES, nothing else.
        pub fn plain() -> Self {
            Self {
                tone_map: ToneMap::Aces,
                exposure_ev: 0.0,
                bloom: 0.0,
                beam_fwhm: 0.0,
                colour_map: ColourMap::None,
                glare_is_optional: false,
                ..Self::default()
            }
        }
    }

    impl Sky {
        /// The real stars and the Milky Way.
        pub fn plain() -> Self {
            Self {
                flags: Self::STARS | Self::MILKY_WAY,
                stars_brightness: 1.0,
                map_brightness: 1.0,
                orientation: DQuat::IDENTITY,
                seed: 0,
                ..Self::default()
            }
        }
    }

    impl Camera {
        /// At rest at (0, -30, 5), 60 degrees of view.
        pub fn plain() -> Self {
            let position = DVec3::new(0.0, -30.0, 5.0);
            Self {
                projection: Projection::Perspective,
                position,
                forward: -position,
                up: DVec3::Z,
                fov_y: std::f64::consts::FRAC_PI_3,
                motion: Motion::Static,
                velocity: DVec3::ZERO,
                ..Self::default()
            }
        }
    }

    impl Scene {
        /// A hole without spin, a smooth disk before the stars, and nothing that is only for the eye: for tests, whose
        /// numbers depend on it, and which must not change with the default scene.
        pub fn plain() -> Self {
            Self {
                hole: Hole::default(),
                camera: Camera::plain(),
                disk: Some(Disk::plain()),
                sky: Sky::plain(),
                sky_map: None,
                sky_picture: None,
                film: Film::plain(),
                effects: Effects(Effects::ALL),
                time: 0.0,
                quality: Quality::default(),
                view: View::Light,
                ..Self::default()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Preset; 4] = [Preset::Cinematic, Preset::Physical, Preset::Observatory, Preset::Teaching];

    /// A scene of which everything differs from the defaults.
    fn odd() -> Scene {
        let mut scene =
            Scene { time: 17.0, shutter: 0.5, view: View::Order, effects: Effects(0), disk: None, ..Scene::default() };
        scene.hole.spin = 0.4;
        scene.camera.fov_y = 0.3;
        scene.quality.samples_per_pixel = 7;
        scene.sky = Sky { flags: Sky::MAP, stars_brightness: 9.0, map_brightness: 8.0, seed: 3, ..scene.sky };
        scene.sky.orientation = DQuat::from_rotation_x(0.3);
        scene.film = Film { bloom: 0.9, beam_fwhm: 0.9, exposure_ev: 9.0, ..scene.film };
        scene
    }

    #[test]
    fn presets_are_valid_and_set_their_part_only() {
        for preset in ALL {
            let (mut scene, before) = (odd(), odd());
            preset.apply(&mut scene);
            scene.disk.expect("a disk").check().expect("a valid disk");
            scene.film.check().expect("a valid film");
            scene.sky.check().expect("a valid sky");
            assert_eq!((scene.hole, scene.camera), (before.hole, before.camera), "{preset:?}");
            assert_eq!((scene.time, scene.shutter, scene.view), (17.0, 0.5, View::Order), "{preset:?}");
            assert_eq!(scene.quality, before.quality, "{preset:?}");
            assert_eq!((scene.sky.orientation, scene.sky.seed), (before.sky.orientation, 3), "{preset:?}");
        }
    }

    /// Looks with depth have a volume instead of the disk, and nothing else is another.
    #[test]
    fn depth_replaces_the_disk_alone() {
        for preset in ALL {
            let (mut thin, mut deep) = (odd(), odd());
            deep.volumes.push(Volume::default());
            preset.apply(&mut thin);
            let matter = preset.apply_with(PresetMatter::Deep, &mut deep);
            assert_eq!(preset.has_depth(), matter == PresetMatter::Deep, "{preset:?}");
            assert_eq!(preset.has_depth(), deep.disk.is_none(), "{preset:?}");
            assert_eq!(preset.has_depth(), deep.volumes.len() == 1, "{preset:?}");
            deep.volumes.iter().for_each(|volume| volume.check().expect("a valid volume"));
            let rest = |scene: &Scene| (scene.film, scene.effects, scene.sky.flags, scene.hole, scene.camera);
            assert_eq!(rest(&deep), rest(&thin), "{preset:?}");
            assert_eq!(preset.apply_with(PresetMatter::Thin, &mut deep), PresetMatter::Thin);
            assert_eq!((deep.disk, deep.volumes.len()), (thin.disk, 0), "{preset:?}");
        }
    }

    /// A preset takes away the volume of another; a volume of the host's, or one that it changed, stays.
    #[test]
    fn a_presets_volume_leaves_with_it() {
        let mut scene = odd();
        Preset::Cinematic.apply_with(PresetMatter::Deep, &mut scene);
        Preset::Physical.apply(&mut scene);
        assert!(scene.volumes.is_empty() && scene.disk.is_some());
        Preset::Cinematic.apply_with(PresetMatter::Deep, &mut scene);
        scene.volumes[0].absorption = 1.0;
        let own = scene.volumes.clone();
        Preset::Physical.apply(&mut scene);
        assert_eq!(scene.volumes, own);
        // A volume that the host sets is the host's, even with the values of a look's.
        let mut scene = odd();
        scene.volumes.push(Preset::Cinematic.volume().expect("a volume"));
        Preset::Cinematic.apply(&mut scene);
        assert_eq!(scene.volumes.len(), 1);
    }

    /// Whatever was set before, the same preset gives the same look, and each another one.
    #[test]
    fn a_preset_does_not_depend_on_the_one_before() {
        let look = |preset: Preset, mut scene: Scene| {
            preset.apply(&mut scene);
            (scene.disk, scene.film, scene.effects, scene.sky.flags)
        };
        for (i, preset) in ALL.into_iter().enumerate() {
            let fresh = look(preset, odd());
            for (k, other) in ALL.into_iter().enumerate() {
                let mut scene = odd();
                other.apply(&mut scene);
                assert_eq!(look(preset, scene), fresh, "{preset:?} after {other:?}");
                assert_eq!(i == k, look(other, odd()) == fresh, "{preset:?} and {other:?}");
            }
        }
    }
}
