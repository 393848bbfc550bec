/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What counts as changed: subdomains kept, evaluated, gathered, and changed in the frames of their
 * nodes. */
#include "assemble/subdomain_bar.h"

static void what_counts_as_changed(void **state) {
  bw_context *context = check_context(state);
  const double axis[3] = {0.3, -0.2, 1}, origin[3] = {0}, joint[3] = {0.75, 0.2, 0.1};
  double q[9], small[9];
  turn(1.1, axis, q);
  turn(0.1, axis, small);
  session now;
  session_create(context, 2, true, false, &now);
  session_update(context, &now);
  check_state_is(&now, "5K 0E 0G 00000");
  /* moved as a whole: nothing; turned as a whole: written, not changed */
  for (int r = 0; r < RIGID; r++)
    now.p.shift[r][1] = 0.7;
  session_update(context, &now);
  check_state_is(&now, "5K 0E 0G 00000");
  turn_from(&now.p, 0, q, origin);
  session_update(context, &now);
  check_state_is(&now, "0K 5E 0G 00000");
  assert_int_equal(now.change.blocks, now.b.pattern->block_count);
  /* a bend at the first joint: all that hangs on it is written, the blended subdomain changed */
  turn_from(&now.p, 1, small, joint);
  session_update(context, &now);
  check_state_is(&now, "1K 3E 1G 01000");
  /* turned as a whole with a bend in it: the bent subdomain is gathered again, and has not changed
   */
  turn_from(&now.p, 0, q, joint);
  session_update(context, &now);
  check_state_is(&now, "0K 4E 1G 00000");
  /* moved as a whole with a bend in it */
  for (int r = 0; r < RIGID; r++)
    now.p.shift[r][2] += 0.25;
  session_update(context, &now);
  check_state_is(&now, "5K 0E 0G 00000");
  /* the last part made thicker: it and the blended one before it */
  now.p.stretch[2][4] = 1.2;
  session_update(context, &now);
  check_state_is(&now, "3K 1E 1G 00011");
  session_update(context, &now);
  check_state_is(&now, "5K 0E 0G 00000");
  /* nodes of a subdomain of type R moved on their own, and back */
  now.p.bulged[2] = true;
  session_update(context, &now);
  check_state_is(&now, "4K 0E 1G 00100");
  now.p.bulged[2] = false;
  session_update(context, &now);
  check_state_is(&now, "4K 1E 0G 00100");
  /* back to rest at once */
  pose_rest(&now.p);
  session_update(context, &now);
  check_state_is(&now, "0K 5E 0G 01011");
  session_clear(&now);

  /* axes that stay: turning as a whole changes everything; axes that turn: nothing */
  session_create(context, 1, false, false, &now);
  turn_from(&now.p, 0, q, origin);
  session_update(context, &now);
  check_state_is(&now, "0K 5E 0G 11111");
  session_clear(&now);
  session_create(context, 1, false, true, &now);
  turn_from(&now.p, 0, q, origin);
  session_update(context, &now);
  check_state_is(&now, "0K 5E 0G 00000");
  session_clear(&now);
}

/* Nodes in the global frame, and nodes of a neighbour: a subdomain changes when it turns against
 * either, though it may itself be left alone. */
static void frames_of_nodes_count(void **state) {
  bw_context *context = check_context(state);
  const double axis[3] = {0, 0, 1}, origin[3] = {0};
  double q[9];
  turn(0.3, axis, q);
  session now;
  session_create(context, 1, true, false, &now);
  int first_node = -1; /* of subdomain 0 alone */
  for (int i = 0; i < now.b.rest->node_count && first_node < 0; i++)
    first_node = now.b.rest->node[3 * i] < 0.1 ? i : -1;
  now.b.node_subdomain[first_node] = -1;
  bw_release(now.s);
  check_ok(context, bw_subdomain_stiffness_create(context, now.b.pattern, now.b.rest, now.material,
                                                  false, SUBDOMAINS, now.b.element_subdomain,
                                                  now.b.node_subdomain, &now.s));
  turn_from(&now.p, 0, q, origin);
  session_update(context, &now);
  check_state_is(&now, "0K 5E 0G 10000");
  /* the frame of subdomain 2 turned alone: entries of its neighbours at shared nodes change too */
  bw_subdomain_motion other[SUBDOMAINS];
  memcpy(other, now.motion, sizeof other);
  times(q, other[2].frame, other[2].frame);
  check_ok(context, bw_subdomain_stiffness_update(context, now.s, now.b.rest, now.s->material,
                                                  other, &now.change));
  check_state_is(&now, "5K 0E 0G 01110");
  session_clear(&now);
}

check_main(check_test(what_counts_as_changed), check_test(frames_of_nodes_count))
