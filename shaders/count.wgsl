// Kernel: the steps of all rays of a traced rectangle, summed. In a pass of its own: a barrier or an atomic for every pixel
// would cost the tracing kernel more than this does.

@group(0) @binding(0) var<uniform> pass_: Pass;
@group(0) @binding(1) var<storage, read> records: array<u32>;
@group(0) @binding(2) var<storage, read_write> step_sum: atomic<u32>;

const COUNTERS: u32 = 8192u;

@compute @workgroup_size(64)
fn count_steps(@builtin(global_invocation_id) id: vec3<u32>) {
    let pixels = pass_.size.x * pass_.size.y;
    var sum = 0u;
    for (var i = id.x; i < pixels; i += COUNTERS) {
        sum += records[RECORD_STEPS * pixels + i];
    }
    atomicAdd(&step_sum, sum);
}
