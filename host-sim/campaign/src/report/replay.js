// Two flights at one time: play, pause, scrub, speed.
class Replay {
  constructor(flights) {
    this.flights = flights;
    this.time = 0;
    this.playing = false;
    this.speed = 1;
    this.shown = [null, null];
    const get = (id) => document.getElementById(id);
    this.parts = { play: get("play"), scrub: get("scrub"), clock: get("clock"), error: get("error") };
    this.space = new Space(get("space"), () => this.draw());
    [get("first"), get("second")].forEach((select, which) => {
      if (which) select.append(new Option("none", ""));
      flights.forEach((flight, i) => select.append(new Option(named(flight), i)));
      select.addEventListener("change", () => this.show(which, select.value));
      const start = which ? flights.findIndex((flight) => flights[0] && flight.law !== flights[0].law) : 0;
      select.value = start >= 0 && flights.length ? String(start) : "";
      this.shown[which] = flights[select.value] || null;
    });
    this.parts.play.addEventListener("click", () => this.setPlaying(!this.playing));
    this.parts.scrub.addEventListener("input", () => {
      const [from, to] = this.span();
      this.time = from + Number(this.parts.scrub.value) * (to - from);
      this.draw();
    });
    get("speed").addEventListener("change", (event) => (this.speed = Number(event.target.value)));
    this.reset();
  }

  show(which, index) {
    this.shown[which] = index === "" ? null : this.flights[Number(index)];
    this.reset();
  }

  span() {
    const there = this.shown.filter((flight) => flight && flight.rows.length);
    if (!there.length) return [0, 1];
    return [Math.min(...there.map((f) => f.rows[0][0])), Math.max(...there.map((f) => f.rows[f.rows.length - 1][0]))];
  }

  reset() {
    this.time = this.span()[0];
    const course = this.shown.filter(Boolean).flatMap((flight) => flight.rows.map((row) => row.slice(1, 4)));
    if (course.length) this.space.fit(course);
    this.draw();
  }

  setPlaying(playing) {
    const [from, to] = this.span();
    if (playing && this.time >= to) this.time = from;
    this.playing = playing;
    this.parts.play.textContent = playing ? "Pause" : "Play";
    let last = null;
    const step = (now) => {
      if (!this.playing) return;
      if (last !== null) this.time += ((now - last) / 1000) * this.speed;
      last = now;
      if (this.time >= to) {
        this.time = to;
        this.setPlaying(false);
      }
      this.draw();
      if (this.playing) requestAnimationFrame(step);
    };
    if (playing) requestAnimationFrame(step);
  }

  // The sample before the time; the last one after the end.
  at(flight) {
    const rows = flight.rows;
    let [low, high] = [0, rows.length - 1];
    while (low < high) {
      const middle = Math.ceil((low + high) / 2);
      if (rows[middle][0] <= this.time + 1e-9) low = middle;
      else high = middle - 1;
    }
    return low;
  }

  draw() {
    const [from, to] = this.span();
    this.parts.scrub.value = String((this.time - from) / (to - from || 1));
    this.parts.clock.textContent = this.time.toFixed(2) + " s";
    this.space.clear();
    const longest = this.shown.filter(Boolean).sort((a, b) => b.rows.length - a.rows.length)[0];
    if (longest) this.space.line(longest.rows.map((row) => row.slice(1, 4)), "#9aa3ad", 1.2, [5, 4]);
    this.shown.forEach((flight, which) => {
      if (!flight || !flight.rows.length) return;
      const colour = COLOURS[which];
      const index = this.at(flight);
      const row = flight.rows[index];
      this.space.line(flight.rows.slice(0, index + 1).map((r) => r.slice(4, 7)), colour, 1.5);
      this.space.craft(row.slice(4, 7), row.slice(7, 11), colour);
      if (!which) this.space.arrow([0, 0, 0.02], row.slice(15, 18), "#00879e");
      this.space.c.fillStyle = colour;
      this.space.c.font = "13px system-ui, sans-serif";
      const lost = index === flight.rows.length - 1 && flight.lost_s !== null ? `, lost at ${flight.lost_s.toFixed(2)} s` : "";
      this.space.c.fillText(`${named(flight)}: ${error(row).toFixed(3)} m${lost}`, 12, 22 + 18 * which);
    });
    this.drawError(from, to);
    document.body.dataset.time = this.time.toFixed(3);
  }

  drawError(from, to) {
    const there = this.shown.filter((flight) => flight && flight.rows.length);
    if (!there.length) return;
    const most = Math.max(1e-3, ...there.map((flight) => Math.max(...flight.rows.map(error))));
    const f = frame(this.parts.error, { x: [from, to], y: [0, most], xName: "time, s", yName: "error, m" });
    this.shown.forEach((flight, which) => {
      if (flight) curve(f.c, flight.rows.map((row) => [f.px(row[0]), f.py(error(row))]), COLOURS[which], 1.4);
    });
    f.c.strokeStyle = "#1b1f24";
    line(f.c, f.px(this.time), f.top, f.px(this.time), f.bottom);
  }
}

function error(row) {
  return Math.hypot(row[4] - row[1], row[5] - row[2], row[6] - row[3]);
}

function named(flight) {
  return `${flight.law}, run ${flight.run} (${flight.kind})`;
}
