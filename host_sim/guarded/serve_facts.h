/* SPDX-License-Identifier: MIT */
/* What a plugin says of itself, put into the block by the guard's child, and taken out of it by the host. */
#ifndef HS_SERVE_FACTS_H
#define HS_SERVE_FACTS_H

#include "guarded/serve_state.h"

/* [child] Asks the open plugin for everything that stays the same. It may crash in any of that. */
void hs_server_facts(hs_server *server);

#endif
