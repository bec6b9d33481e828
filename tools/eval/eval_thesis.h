/* SPDX-License-Identifier: MIT */
/* What the thesis measured, to stand beside our own numbers: facts from Tables 5.2, 5.3 and 5.4. */
#ifndef HS_EVAL_THESIS_H
#define HS_EVAL_THESIS_H

/* One case. Errors in DVR steps of the thesis' renderer. Its e_pos and e_neg contradict e_abs in several rows
 * (spec 9), so only e_abs is kept. */
typedef struct {
    const char *name;
    double threshold, delta, kernel, knob, e_abs; /* Table 5.2: T_B, Delta_MI, k, q */
    double common_knob, common_e_abs;             /* Table 5.3: Delta_MI 0.24, k 55 */
} hs_eval_thesis_case;

/* NULL if the thesis has no such case. */
const hs_eval_thesis_case *hs_eval_thesis_find(const char *name);

/* Table 5.3's common setting. */
#define HS_EVAL_THESIS_DELTA  0.24
#define HS_EVAL_THESIS_KERNEL 55

/* Table 5.4, milliseconds: the average over the cases. */
typedef struct {
    const char *stage;
    double ms;
} hs_eval_thesis_stage;
extern const hs_eval_thesis_stage hs_eval_thesis_stages[5];

/* Frames a second that the plugin costs on average (thesis 5.4, on Figure 5.21). */
#define HS_EVAL_THESIS_LOST_FPS 6

/* Why the numbers cannot be compared one by one. */
extern const char hs_eval_thesis_note[];

#endif
