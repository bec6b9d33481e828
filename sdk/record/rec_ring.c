/* SPDX-License-Identifier: MIT */
#include "record/rec_ring.h"

#include <errno.h>
#include <unistd.h>

#define ONE_WRITE (UINT32_C(1) << 30) /* what every system takes at once */

bool rec_write_all(int file, const void *data, size_t bytes) {
    const char *from = data;
    while (bytes > 0) {
        const ssize_t n = write(file, from, bytes < ONE_WRITE ? (uint32_t)bytes : ONE_WRITE);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) return false;
        from += n;
        bytes -= (size_t)n;
    }
    return true;
}

static bool copy_part(int from, int to, rec_part p) {
    char block[1 << 16];
    if (lseek(from, (off_t)p.from, SEEK_SET) < 0) return false;
    while (p.from < p.to) {
        const uint64_t left = p.to - p.from;
        const ssize_t n = read(from, block, left < sizeof block ? (uint32_t)left : (uint32_t)sizeof block);
        if (n <= 0 || !rec_write_all(to, block, (size_t)n)) return false;
        p.from += (uint64_t)n;
    }
    return true;
}

static uint64_t bytes_of(rec_part p) {
    return p.to - p.from;
}

/* Where a part lies once the file is cut: what lay before `first` at `place`, all else
 * earlier by `shift`. */
static rec_part moved(rec_part p, uint64_t first, uint64_t place, uint64_t shift) {
    const uint64_t from = p.from < first ? place : p.from - shift;
    return (rec_part){from, from + bytes_of(p)};
}

static const rec_place *first_of(const rec_ring *ring) {
    return &ring->frames[ring->count - ring->keep];
}

bool rec_ring_copy(const rec_ring *ring, int from, int to, uint64_t end) {
    const rec_place *const first = first_of(ring);
    return copy_part(from, to, (rec_part){0, ring->head}) && copy_part(from, to, first->activation) &&
           copy_part(from, to, first->volume) && copy_part(from, to, (rec_part){first->at, end});
}

uint64_t rec_ring_forget(rec_ring *ring, uint64_t end) {
    const rec_place first = *first_of(ring);
    const uint64_t volume = ring->head + bytes_of(first.activation);
    const uint64_t shift = first.at - volume - bytes_of(first.volume);
    for (uint32_t i = 0; i <= ring->keep; i++) {
        rec_place *p = i < ring->keep ? &ring->frames[i] : &ring->now;
        if (i < ring->keep) *p = ring->frames[ring->count - ring->keep + i];
        p->at -= shift;
        p->activation = moved(p->activation, first.at, ring->head, shift);
        p->volume = moved(p->volume, first.at, volume, shift);
    }
    ring->count = ring->keep;
    return end - shift;
}

bool rec_ring_is_full(const rec_ring *ring) {
    return ring->keep && ring->count == 2 * ring->keep;
}

void rec_ring_frame(rec_ring *ring, uint64_t end, bool same) {
    if (ring->keep == 0) return;
    ring->now.at = end;
    if (!same || !ring->shown)
        ring->now.volume = (rec_part){end, end};
    else if (bytes_of(ring->now.volume) == 0)
        ring->now.volume.to = end;
    ring->shown = true;
    ring->frames[ring->count++] = ring->now;
}

void rec_ring_activation(rec_ring *ring, uint64_t end) {
    ring->now.activation = (rec_part){end, end};
    ring->shown = false;
}

void rec_ring_activated(rec_ring *ring, uint64_t end) {
    ring->now.activation.to = end;
}
