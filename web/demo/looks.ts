// SPDX-License-Identifier: MIT OR Apache-2.0
// looks.ts -- the scenes of the page's cards. Their thumbnails, thumbnails/ID.webp, are made by thumbnails.mjs.

import type { Settings } from "./bhr/index.js";

export interface Look {
    id: string;
    name: string;
    about: string;
    settings: Settings;
    /** Matter with depth takes many times as long as a thin disk. */
    isDeep?: boolean;
}

const degrees = (angle: number) => Number(((angle * Math.PI) / 180).toFixed(5));

/** A camera in orbit; angles in degrees. */
function orbit(distance: number, azimuth: number, elevation: number, fov: number) {
    const place = { distance, azimuth: degrees(azimuth), elevation: degrees(elevation) };
    return { orbit: place, fov_y: degrees(fov) };
}

const turn = (right: number, up: number, roll: number) => ({
    turn: { right: degrees(right), up: degrees(up), roll: degrees(roll) },
});

export const LOOKS: readonly { title: string; looks: readonly Look[] }[] = [
    {
        title: "Looks",
        looks: [
            {
                id: "cinematic", name: "Cinematic", about: "A golden disk with structure, and glare",
                settings: { preset: "cinematic" },
            },
            {
                id: "physical", name: "Physical", about: "A smooth disk as a physicist expects it, without glare",
                settings: { preset: "physical", hole: { spin: 0.5 }, camera: orbit(32, 90, 9, 50) },
            },
            {
                id: "observatory", name: "Observatory", about: "As the Event Horizon Telescope shows its sources",
                settings: { preset: "observatory", camera: orbit(30, 90, 73, 60) },
            },
            {
                id: "teaching", name: "Teaching", about: "A grid on the sky; the disk in the colours of its shifts",
                settings: { preset: "teaching", camera: orbit(26, 90, 14, 45) },
            },
        ],
    },
    {
        title: "Views",
        looks: [
            {
                id: "gargantua", name: "As in films", about: "Beaming and the Doppler shift are nearly off",
                settings: {
                    effect_strengths: [0.15, 1, 0.1],
                    hole: { spin: 0.6 },
                    camera: orbit(58, 215, 4.5, 26),
                    disk: { inner_radius: 5, outer_radius: 21, temperature: 3600 },
                    sky: { map_brightness: 3 },
                    film: { tone_map: "filmic", exposure_ev: 0.3, shoulder_strength: 5, shoulder_length: 0.8,
                        contrast: 1.1, saturation: 1.1, vignette: 0.3 },
                },
            },
            {
                id: "high-spin", name: "High spin", about: "Spin 0.998: the disk reaches in to 1.24 M",
                settings: {
                    preset: "cinematic", hole: { spin: 0.998 }, camera: orbit(32, 75, 9, 42),
                    disk: { brightness: 0.15 }, film: { exposure_ev: -0.5, highlights: 0.5, shadows: 0.2 },
                },
            },
            {
                id: "near", name: "Close up", about: "A tilted look across the disk, 15 M away",
                settings: {
                    preset: "cinematic", hole: { spin: 0.9 }, camera: { ...orbit(15, 60, 13, 56), ...turn(3, 1, -24) },
                    disk: { outer_radius: 18, temperature: 3000, brightness: 0.15 }, sky: { map_brightness: 2 },
                    film: { bloom: 0.2, highlights: 0.55, shadows: 0.15, contrast: 1.15, vignette: 0.4 },
                },
            },
            {
                id: "crescent", name: "Crescent",
                about: "Nearly edge-on: the approaching side outshines the receding one",
                settings: {
                    preset: "cinematic", hole: { spin: 0.94 }, camera: orbit(40, 75, 1.6, 30),
                    disk: { outer_radius: 16, temperature: 3200, brightness: 0.43 },
                    sky: { stars_brightness: 1.5, map_brightness: 4 },
                    film: { highlights: 0.5, shadows: 0.2, contrast: 1.15, saturation: 1.1, vignette: 0.4 },
                },
            },
            {
                id: "face-on", name: "Face on", about: "From above the disk of a hole of spin 0.98",
                settings: {
                    preset: "cinematic", hole: { spin: 0.98 }, camera: orbit(34, 20, 86, 56),
                    disk: { outer_radius: 20, temperature: 3800, brightness: 0.28 }, sky: { map_brightness: 2.5 },
                    film: { highlights: 0.5, shadows: 0.15, contrast: 1.2, vignette: 0.5 },
                },
            },
            {
                id: "einstein-ring", name: "Einstein ring", about: "Orion behind a bare hole, 100 M away",
                settings: {
                    preset: "cinematic", disk: false, camera: orbit(100, 263, -1, 26), film: { exposure_ev: 2.5 },
                },
            },
            {
                id: "galactic-centre", name: "Milky Way", about: "The middle of our galaxy becomes a ring",
                settings: {
                    preset: "cinematic", disk: false, camera: orbit(40, 86.4, 28.9, 60), film: { exposure_ev: 0.5 },
                },
            },
            {
                id: "redshift", name: "Redshift", about: "The shift g of the light, in false colour",
                settings: { view: "redshift", hole: { spin: 0.7 }, camera: orbit(28, 90, 14, 45) },
            },
        ],
    },
    {
        title: "Journeys",
        looks: [
            {
                id: "fall", name: "A fall", about: "Through the horizon of a hole without spin, from 12 M",
                settings: {
                    preset: "cinematic",
                    camera: { ...orbit(12, -90, 20, 100), motion: "free_fall", proper_time: 12 },
                    disk: { outer_radius: 16, turbulence: 0.8 },
                    film: { exposure_ev: -1.5, tone_map: "agx", bloom: 0.15 },
                },
            },
            {
                id: "plunge", name: "A plunge", about: "Into a hole of spin 0.9, above its disk",
                settings: {
                    preset: "cinematic", hole: { spin: 0.9 },
                    camera: { ...orbit(8, -90, 28, 96), motion: "free_fall", chart: "rain", proper_time: 7.5 },
                    disk: { brightness: 0.03, temperature: 2400 }, sky: { map_brightness: 1.5 },
                    film: { exposure_ev: -1.5, bloom: 0.12, highlights: 0.55, shadows: 0.15, contrast: 1.1,
                        saturation: 1.2, vignette: 0.3 },
                },
            },
            {
                id: "orbit", name: "In orbit", about: "At 7 M, near the last stable orbit: 0.45 of the speed of light",
                settings: {
                    preset: "cinematic",
                    camera: { ...orbit(7, -90, 20, 95), ...turn(45, 0, 0), motion: "orbit" },
                    film: { highlights: 0.5, shadows: 0.1 },
                },
            },
        ],
    },
    {
        title: "With depth",
        looks: [
            {
                id: "soft-disk", name: "Soft disk", about: "A disk of mist, a twentieth of its radius thick",
                isDeep: true,
                settings: {
                    preset: "cinematic", disk: false, hole: { spin: 0.6 }, camera: orbit(28, 75, 6.5, 37.6),
                    volumes: [{ shape: "disk" }], film: { tone_map: "agx", exposure_ev: 1.5 },
                    sky: { stars_brightness: 0.354, map_brightness: 0.354 },
                },
            },
            {
                id: "hot-spot", name: "Hot spot", about: "A glowing blob in orbit at 7 M, over a dim disk",
                isDeep: true,
                settings: {
                    preset: "cinematic", hole: { spin: 0.6 }, camera: orbit(30, 75, 13, 38),
                    disk: { brightness: 0.06, temperature: 2600 },
                    hot_spots: [{ radius: 7, size: 0.55, azimuth: 0.244, brightness: 12, tint: [0.6, 0.8, 1] }],
                    film: { tone_map: "filmic", toe_strength: 0.3, toe_length: 0.2, shoulder_strength: 4,
                        exposure_ev: 1.5, bloom: 0.35 },
                    sky: { stars_brightness: 0.5, map_brightness: 0.3 },
                },
            },
            {
                id: "jet", name: "Jets", about: "Hollow jets at 0.85 of the speed of light", isDeep: true,
                settings: {
                    preset: "cinematic", disk: { brightness: 0.2, outer_radius: 15 }, hole: { spin: 0.9 },
                    camera: { ...orbit(50, 75, 18, 54), ...turn(1, 5, -32) },
                    volumes: [{ shape: "jet", flow: "outflow", flags: ["power_law"], inner_radius: 2.2,
                        outer_radius: 110, radius: 20, opening: 0.33, thickness: 0.012, slope: 1.5, absorption: 0,
                        spectral_index: 0.7, brightness: 0.16, speed: 0.85, clumping: 1.2, tint: [0.25, 0.36, 1] }],
                    film: { tone_map: "filmic", toe_strength: 0.3, toe_length: 0.2, shoulder_strength: 4,
                        exposure_ev: 2.4, bloom: 0.35, saturation: 1.1, vignette: 0.3 },
                    sky: { stars_brightness: 0.4, map_brightness: 0.2 },
                },
            },
        ],
    },
];

/** A look by its name in addresses and tests. */
export function lookOf(id: string): Look | undefined {
    return LOOKS.flatMap(({ looks }) => looks).find((look) => look.id === id);
}
