// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// How sharp the pictures of a moving view are: fewer pixels where they come slowly, all of them where they can.

// Milliseconds between two pictures: more is slow; as many or less is fast. Fewer pixels by one step take 0.64 of the
// time, so that a step back from a fast pace is never slow.
const SLOW = 34;
const FAST = 20;
const STEP = 0.8;
const LEAST = 0.4;

export class Pace {
  constructor() {
    this.share = 1; // of the pixels along a side
    this.last = -Infinity;
    this.intervals = [];
  }

  // Takes the time of a picture while the view moves, in milliseconds; the share of pixels of the next ones. A longer
  // pause is none of the pace.
  picture(now) {
    const interval = now - this.last;
    this.last = now;
    if (interval > 1000) this.intervals = [];
    else this.intervals.push(interval);
    if (this.intervals.length < 4) return this.share;
    const median = this.intervals.sort((a, b) => a - b)[1];
    this.intervals = [];
    if (median > SLOW) this.share = Math.max(LEAST, this.share * STEP);
    else if (median <= FAST) this.share = Math.min(1, this.share / STEP);
    return this.share;
  }
}
