/* SPDX-License-Identifier: MIT */
/* Which frames of a recording stay, where only the last ones do, and where they lie in its file. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Bytes of the file. */
typedef struct {
    uint64_t from, to;
} rec_part;

/* Where a frame begins in the file, and what a ring that begins with it needs: its activation, and the frame
 * that brought its volume, from its begin to the next one's; empty if it is that frame. */
typedef struct {
    uint64_t at;
    rec_part activation, volume;
} rec_place;

typedef struct {
    uint32_t keep;     /* frames; 0: all */
    uint64_t head;     /* of what every recording begins with: the header, create, the plugin */
    rec_place *frames; /* up to 2 * keep */
    uint32_t count;
    rec_place
        now;    /* the last activate, from its call to behind its return; the last frame of another volume */
    bool shown; /* there was such a frame since */
} rec_ring;

bool rec_write_all(int file, const void *data, size_t bytes);

/* An activation begins at the end of the file, or has returned there. */
void rec_ring_activation(rec_ring *ring, uint64_t end);
void rec_ring_activated(rec_ring *ring, uint64_t end);

/* A frame begins there. `same`: it is told to show the volume of the frame before, of which a plugin may know
 * more than this frame brings. */
void rec_ring_frame(rec_ring *ring, uint64_t end, bool same);

/* There is no room for another one. */
bool rec_ring_is_full(const rec_ring *ring);

/* Copies the last frames, and what the first of them needs, from a file of `end` bytes to another one; then
 * forgets the others. Returns the bytes of the other file. */
bool rec_ring_copy(const rec_ring *ring, int from, int to, uint64_t end);
uint64_t rec_ring_forget(rec_ring *ring, uint64_t end);
