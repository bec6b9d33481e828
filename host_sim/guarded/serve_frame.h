/* SPDX-License-Identifier: MIT */
/* A frame, or another value on the last one, in the guard's child. */
#ifndef HS_SERVE_FRAME_H
#define HS_SERVE_FRAME_H

#include "guarded/serve_state.h"

/* The frame that the block describes: begin, every slab, end, and what follows it. Results are in the block
 * and the maps when it returns. */
sv_status hs_server_frame(hs_server *server);

/* The same for adjust. */
sv_status hs_server_adjust(hs_server *server);

/* What the block's `follow` asks for, of the last frame. */
sv_status hs_server_follow(hs_server *server);

#endif
