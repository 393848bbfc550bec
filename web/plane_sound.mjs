// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// A bar's tone by WebAudio: a stroke is a sum of sines that die away as exp(-pi loss f t); while an
// outline is dragged, one sine follows its frequency. Browsers let sound begin with a click or a key.

export class Sound {
  constructor() {
    this.strokes = 0;
    this.sounding = []; // frequencies of the last stroke
  }

  start() {
    if (!this.context) {
      this.context = new AudioContext();
      this.out = this.context.createGain();
      this.out.gain.value = 0.5;
      this.analyser = this.context.createAnalyser();
      this.out.connect(this.analyser);
      this.analyser.connect(this.context.destination);
    }
    this.context.resume();
    return this.context;
  }

  // {frequencies, gains, loss}
  strike(tone) {
    const context = this.start();
    const now = context.currentTime;
    const most = tone.gains.reduce((a, b) => a + b, 0);
    this.sounding = [];
    tone.frequencies.forEach((f, k) => {
      if (f > 0.45 * context.sampleRate) return;
      const life = 1 / (Math.PI * tone.loss * f);
      const sine = new OscillatorNode(context, { frequency: f });
      const level = new GainNode(context, { gain: 0 });
      level.gain.setValueAtTime(tone.gains[k] / most, now);
      level.gain.setTargetAtTime(0, now, life);
      sine.connect(level).connect(this.out);
      sine.start(now);
      sine.stop(now + Math.min(8, 7 * life));
      this.sounding.push(f);
    });
    this.strokes++;
  }

  // A steady tone that follows the frequency, until hush.
  follow(frequency) {
    const context = this.start();
    const now = context.currentTime;
    if (!this.beep) {
      this.beep = new OscillatorNode(context, { frequency });
      this.level = new GainNode(context, { gain: 0 });
      this.beep.connect(this.level).connect(this.out);
      this.level.gain.setTargetAtTime(0.25, now, 0.02);
      this.beep.start();
    }
    this.beep.frequency.setTargetAtTime(frequency, now, 0.015);
    this.followed = frequency;
  }

  hush() {
    if (!this.beep) return;
    const now = this.context.currentTime;
    this.level.gain.setTargetAtTime(0, now, 0.03);
    this.beep.stop(now + 0.3);
    this.beep = null;
  }

  // For whoever drives the page by script: `loudest` of what the graph gives out now, -1 to 1.
  state() {
    let loudest = 0;
    if (this.analyser) {
      const samples = new Float32Array(this.analyser.fftSize);
      this.analyser.getFloatTimeDomainData(samples);
      for (const s of samples) loudest = Math.max(loudest, Math.abs(s));
    }
    return { running: this.context?.state === "running", strokes: this.strokes, sounding: this.sounding,
      following: !!this.beep, followed: this.followed, loudest };
  }
}
