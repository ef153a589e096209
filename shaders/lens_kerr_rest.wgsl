// Ray records with spin of pixels that the tables of lens_kerr.wgsl do not hold: integrated. Footprints are the tables' all the same.

// u, azimuth, delay, order.
var<private> rest_crossings: array<vec4<f32>, 16>;
var<private> rest_count: u32;
var<private> rest_given: u32;

fn on_crossing(c: Constants, crossing: PlaneCrossing) {
    if crossing.u >= frame.disk_u.x && crossing.u <= frame.disk_u.y {
        var azimuth = 0.0;
        if PATTERN {
            azimuth = wrap_angle(arctan2(crossing.n.y, crossing.n.x) + crossing.drag);
        }
        rest_crossings[min(rest_count, 15u)] = vec4<f32>(crossing.u, azimuth, crossing.delay, f32(crossing.order));
        rest_count += 1u;
    }
}

fn ray_record(id: vec2<u32>) -> Record {
    var record = look_up(id);
    let begin = begin_local(looked.seen.n);
    rest_count = 0u;
    rest_given = 0u;
    let settings = Settings(frame.size.z, frame.size.w, frame.max_steps, frame.max_crossings, frame.capture_u, frame.opaque_u);
    let traced = trace(begin.c, begin.state, settings);
    record.fate = traced.fate;
    record.steps = traced.steps;
    if traced.fate == FATE_ESCAPED {
        let end = escape(begin.c, traced);
        record.sky = chart_direction(end.n, end.drag);
        record.sky_redshift = looked.seen.frequency_ratio / record.energy;
    }
    atomicAdd(&deferred.steps, traced.steps);
    return record;
}

fn next_crossing() -> Crossing {
    var crossing: Crossing;
    if rest_given >= rest_count {
        return crossing;
    }
    let at = rest_crossings[min(rest_given, 15u)];
    rest_given += 1u;
    crossing.u = at.x;
    crossing.g = looked.seen.frequency_ratio * redshift_of(begin_local(looked.seen.n).c, at.x);
    crossing.order = u32(at.w);
    if PATTERN {
        crossing.place = Place(-log(at.x), at.y, at.z);
        put_footprint(&crossing, interpolate(crossing.order));
    }
    return crossing;
}
