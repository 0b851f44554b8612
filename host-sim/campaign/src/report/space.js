// A craft in space on a canvas: an orbit camera, a floor, paths, and a craft with four rotors.
class Space {
  constructor(canvas, changed) {
    this.canvas = canvas;
    this.turn = -0.9;
    this.tilt = 0.5;
    this.centre = [0, 0, 1];
    this.distance = 6;
    let held = null;
    canvas.addEventListener("pointerdown", (event) => {
      held = [event.clientX, event.clientY];
      canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (!held) return;
      this.turn -= (event.clientX - held[0]) * 0.008;
      this.tilt = Math.min(1.5, Math.max(-0.2, this.tilt + (event.clientY - held[1]) * 0.008));
      held = [event.clientX, event.clientY];
      changed();
    });
    canvas.addEventListener("pointerup", () => (held = null));
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.distance = Math.min(200, Math.max(0.3, this.distance * Math.exp(event.deltaY * 0.001)));
      changed();
    }, { passive: false });
  }

  // So that the points fill the view.
  fit(points) {
    const low = [0, 1, 2].map((k) => Math.min(...points.map((p) => p[k])));
    const high = [0, 1, 2].map((k) => Math.max(...points.map((p) => p[k])));
    this.centre = [0, 1, 2].map((k) => (low[k] + high[k]) / 2);
    this.distance = 1.5 * Math.max(1, Math.hypot(...[0, 1, 2].map((k) => high[k] - low[k])));
  }

  // Where a point is on the canvas; nothing behind the camera.
  place(p) {
    const [x, y, z] = [0, 1, 2].map((k) => p[k] - this.centre[k]);
    const [s, c] = [Math.sin(this.turn), Math.cos(this.turn)];
    const [along, across] = [c * x + s * y, -s * x + c * y];
    const [st, ct] = [Math.sin(this.tilt), Math.cos(this.tilt)];
    const depth = this.distance - (ct * along + st * z);
    if (depth < 0.05) return null;
    const size = (0.95 * this.canvas.height) / depth;
    return [this.canvas.width / 2 + across * size, this.canvas.height / 2 - (ct * z - st * along) * size, size];
  }

  line(points, colour, width, dash = []) {
    const c = this.c;
    c.strokeStyle = colour;
    c.lineWidth = width;
    c.setLineDash(dash);
    c.beginPath();
    let down = false;
    for (const point of points) {
      const at = this.place(point);
      if (!at) {
        down = false;
        continue;
      }
      if (down) c.lineTo(at[0], at[1]);
      else c.moveTo(at[0], at[1]);
      down = true;
    }
    c.stroke();
    c.setLineDash([]);
  }

  clear() {
    this.c = this.canvas.getContext("2d");
    this.c.clearRect(0, 0, this.canvas.width, this.canvas.height);
    const [cx, cy] = [Math.round(this.centre[0]), Math.round(this.centre[1])];
    const reach = Math.max(2, Math.ceil(this.distance / 2));
    const step = reach > 20 ? 5 : 1;
    for (let k = -reach; k <= reach; k += step) {
      this.line([[cx + k, cy - reach, 0], [cx + k, cy + reach, 0]], "#e6e9ed", 1);
      this.line([[cx - reach, cy + k, 0], [cx + reach, cy + k, 0]], "#e6e9ed", 1);
    }
    [["x", [1, 0, 0], "#c0392b"], ["y", [0, 1, 0], "#2a8a4a"], ["z", [0, 0, 1], "#0b6bcb"]].forEach(([name, axis, colour]) => {
      this.line([[0, 0, 0], axis.map((v) => 0.5 * v)], colour, 2);
      const at = this.place(axis.map((v) => 0.56 * v));
      if (at) {
        this.c.fillStyle = colour;
        this.c.fillText(name, at[0], at[1]);
      }
    });
  }

  // Arms, rotors as rings, and the thrust; larger than it is, so that it can be seen.
  craft(position, q, colour) {
    const size = Math.max(0.09, 0.03 * this.distance);
    const turned = (v) => rotate(q, v).map((value, k) => position[k] + size * value);
    const arms = [[0.7, -0.7, 0], [-0.7, -0.7, 0], [-0.7, 0.7, 0], [0.7, 0.7, 0]];
    this.line([turned(arms[0]), turned(arms[2])], colour, 3);
    this.line([turned(arms[1]), turned(arms[3])], colour, 3);
    arms.forEach((arm, i) => {
      const ring = [];
      for (let k = 0; k <= 16; k += 1) {
        const angle = (Math.PI * k) / 8;
        ring.push(turned([arm[0] + 0.38 * Math.cos(angle), arm[1] + 0.38 * Math.sin(angle), 0.08]));
      }
      // The front two are darker.
      this.line(ring, i === 0 || i === 3 ? "#1b1f24" : colour, 1.5);
    });
    this.line([turned([0, 0, 0]), turned([0, 0, 1.1])], colour, 2);
    this.line([position, [position[0], position[1], 0]], colour, 0.6, [3, 4]);
  }

  arrow(from, vector, colour) {
    const to = from.map((value, k) => value + 0.3 * vector[k]);
    this.line([from, to], colour, 2);
    const at = this.place(to);
    if (at) {
      this.c.fillStyle = colour;
      this.c.beginPath();
      this.c.arc(at[0], at[1], 3.5, 0, 7);
      this.c.fill();
    }
  }
}

// A vector turned by a quaternion, scalar first.
function rotate([w, x, y, z], v) {
  const t = [2 * (y * v[2] - z * v[1]), 2 * (z * v[0] - x * v[2]), 2 * (x * v[1] - y * v[0])];
  return [
    v[0] + w * t[0] + y * t[2] - z * t[1],
    v[1] + w * t[1] + z * t[0] - x * t[2],
    v[2] + w * t[2] + x * t[1] - y * t[0],
  ];
}
