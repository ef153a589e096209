// SPDX-License-Identifier: MIT OR Apache-2.0
// Hot spots in free fall: where the centre of one is when light leaves, from a table that is made for the frame; how
// dense the spot is at a place, and how it moves. Mirrors src/emit/free_spot.rs, `SpotMatter::free_density` and
// src/physics/rain_motion.rs, where the formulas are. Knows no ray and no light's colour.

#import constants
#import emit/flow
#import emit/shape
#import shared/matter
#requires fn light_table(i: u32) -> vec4<f32>

// Position in Doran's chart, M, its change with T, and the share of the spot that is there.
struct SpotCentre {
    position: vec3<f32>,
    rate: vec3<f32>,
    share: f32,
}

// The centre at `later`, the rain time less that of the frame.
fn spot_centre(later: f32, matter: Matter) -> SpotCentre {
    let passed = (later - matter.law.x) / matter.law.y;
    let even = select(passed, 1.0 - sqrt(max(1.0 - passed, 0.0)), matter.inner > 0.0);
    let last = PLACES_OF_SPOT - 1u;
    // u32 of NaN may be any number.
    let i = min(u32(clamp(even * f32(last), 0.0, f32(last))), last - 1u);
    let entry = matter.places + 2u * i;
    let before = light_table(entry);
    let before_rate = light_table(entry + 1u);
    let after = light_table(entry + 2u);
    let after_rate = light_table(entry + 3u);
    let there = centre_between(before, before_rate, after, after_rate, later);
    return SpotCentre(there.position, there.rate, select(0.0, there.share, passed >= 0.0 && passed <= 1.0));
}

// Between two places of a table (position and share; rate and time), as Node::between.
fn centre_between(
    before: vec4<f32>,
    before_rate: vec4<f32>,
    after: vec4<f32>,
    after_rate: vec4<f32>,
    later: f32,
) -> SpotCentre {
    let span = after_rate.w - before_rate.w;
    let x = clamp((later - before_rate.w) / span, 0.0, 1.0);
    let rise = after.xyz - before.xyz;
    let begin = before_rate.xyz * span;
    let end = after_rate.xyz * span;
    let second = 3.0 * rise - 2.0 * begin - end;
    let third = begin + end - 2.0 * rise;
    return SpotCentre(
        before.xyz + (begin + (second + third * x) * x) * x,
        (begin + (2.0 * second + 3.0 * x * third) * x) / span,
        before.w + (after.w - before.w) * x,
    );
}

// The density at a place of Doran's chart of `azimuth`.
fn free_density(r: f32, cosine: f32, azimuth: f32, centre: SpotCentre, matter: Matter) -> f32 {
    let axis = r * sqrt(max((1.0 - cosine) * (1.0 + cosine), 0.0));
    let place = vec3<f32>(axis * cos(azimuth), axis * sin(azimuth), r * cosine);
    let widths = distance(place, centre.position) / matter.size;
    return select(0.0, centre.share * gaussian(widths), widths < SPOT_CUT);
}

// The velocity (e_r, e_theta, e_phi) that the rain observer at `position` sees of a change of position with T.
fn rain_velocity(a: f32, position: vec3<f32>, rate: vec3<f32>) -> vec3<f32> {
    let r = length(position);
    let e_r = position / r;
    let sine = length(e_r.xy);
    let azimuth = select(vec2<f32>(1.0, 0.0), e_r.xy / max(sine, 1e-30), sine > 0.0);
    let e_theta = vec3<f32>(e_r.z * azimuth, -sine);
    let e_phi = vec3<f32>(-azimuth.y, azimuth.x, 0.0);
    let au = a / r;
    let w = sqrt(2.0 / r);
    let rho2 = 1.0 + au * au * e_r.z * e_r.z;
    let rho = sqrt(rho2);
    let q = sqrt(1.0 + au * au);
    let circumference = sqrt(1.0 + au * au + 2.0 / r * (au * sine) * (au * sine) / rho2);
    let sin_turn = -w * au * sine / (rho * circumference);
    let cos_turn = q / circumference;
    let turn = dot(rate, e_phi);
    let radial = rho / q * dot(rate, e_r) + w / rho * (1.0 - au * sine * turn);
    let around = q * turn;
    return vec3<f32>(
        cos_turn * radial - sin_turn * around,
        rho * dot(rate, e_theta),
        cos_turn * around + sin_turn * radial,
    );
}

// The velocity (along phi; outwards, of the four-velocity; along theta) that the ZAMO measures of matter that the rain
// observer at the same place sees move with `velocity`.
fn zamo_velocity(at: Place, velocity: vec3<f32>) -> vec3<f32> {
    let fall = sqrt(max((1.0 - at.lapse) * (1.0 + at.lapse), 0.0));
    let gamma = inverseSqrt(1.0 - dot(velocity, velocity));
    let slowed = at.lapse / (1.0 - fall * velocity.x);
    return vec3<f32>(slowed * velocity.z, gamma * (velocity.x - fall) / at.lapse, slowed * velocity.y);
}
