// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// A drag as it is sent: begin, moves, end. One move at a time is under way, until its shape is back:
// meanwhile only the newest request is kept. So what is dragged follows the hand as fast as it can and never
// lags behind it.

// A hand is not exact, and the script is to be read.
export const rounded = (x, digits) => Number(x.toFixed(digits)) + 0;

export class Drag {
  // send(message): whether it went out.
  constructor(send) {
    this.send = send;
    this.seq = 0;
    this.drop();
  }

  begin(fields) {
    this.drop();
    this.going = this.send({ type: "begin", seq: ++this.seq, ...fields });
    return this.going;
  }

  move(fields) {
    if (!this.going) return;
    this.wanted = fields;
    if (!this.waiting) this.go();
  }

  go() {
    if (!this.wanted) return;
    this.waiting = ++this.seq;
    this.send({ type: "move", seq: this.waiting, ...this.wanted });
    this.wanted = null;
  }

  // A move has been handled, well or not.
  handled(seq) {
    if (seq !== this.waiting) return;
    this.waiting = 0;
    if (this.going) this.go();
  }

  end() {
    if (!this.going) return;
    this.go();
    this.going = false;
    this.send({ type: "end", seq: ++this.seq });
  }

  // Takes the drag back.
  cancel() {
    if (!this.going) return;
    this.drop();
    this.send({ type: "end", seq: ++this.seq, cancel: true });
  }

  // The drag is over, and nothing more is sent: it was refused, or the connection was lost.
  drop() {
    this.going = false;
    this.wanted = null;
    this.waiting = 0;
  }
}
