/* SPDX-License-Identifier: MIT */
/*
 * What the host does not do: rays sample the grid of the probe, not its Cartesian copy. Compiled before the
 * host's dvr.cl, whose render_volume then is that renderer: the rays, the places of their samples, the leaps
 * over empty bricks of the copy and the sums are the host's, so the two differ in what a sample costs.
 *
 * to_mm: place of index 0 of the copy in mm from the array's centre of curvature, and the edge of a voxel;
 * the others as in convert_beams. What was not scanned is 0.
 */
#define SAMPLED                                                                                              \
    __global const uchar *beams, int4 beam_dims, __global const float *theta, __global const float *phi,     \
        float4 reach, float4 even, float4 to_mm
#define SAMPLE(p, dn, t) sample_probe(beams, beam_dims, theta, phi, reach, even, to_mm, p, dn, t)

INLINE vf sample_probe(SAMPLED, packet p, float4 dn, float n) {
    vi in;
    packet at = {to_mm.x + (p.x + n * dn.x) * to_mm.w, to_mm.y + (p.y + n * dn.y) * to_mm.w,
                 to_mm.z + (p.z + n * dn.z) * to_mm.w};
    return echoes_at(beams, beam_dims, theta, phi, reach, even, at, &in);
}
