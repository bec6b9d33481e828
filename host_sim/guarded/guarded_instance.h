/* SPDX-License-Identifier: MIT */
/* The instance that stands before a guarded plugin: an sv_plugin whose every call goes to the child. */
#ifndef HS_GUARDED_INSTANCE_H
#define HS_GUARDED_INSTANCE_H

#include "guarded/guard_link.h"

/* Fills in guard->instance; the facts must be there. */
void hs_guarded_instance(hs_guard *guard);

/* True for an instance that a guard made. */
bool hs_guarded_is_one(const sv_plugin *instance);

/* Ends the child as it is meant to: deactivate, destroy. Nothing may be asked of it after that. */
void hs_guarded_end(hs_guard *guard);

#endif
