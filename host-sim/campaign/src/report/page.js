// The page: tables, pictures and the replay of the flights in DATA.
(() => {
  const get = (id) => document.getElementById(id);
  const { summary, laws, drawn } = DATA;
  document.title = get("title").textContent = DATA.title;
  get("conditions").textContent = DATA.conditions;
  get("note").textContent =
    (summary.within_m === null ? "Success: flown to its end." : `Success: flown to its end within ${summary.within_m} m.`) +
    " Percentiles count a lost flight as worse than any other. Flights that were refused, for figures without sense together, count for nothing.";

  const table = (names, rows) => {
    const made = document.createElement("table");
    const add = (cells, tag) => {
      const row = made.insertRow();
      for (const cell of cells) {
        const made = document.createElement(tag);
        made.append(cell);
        row.append(made);
      }
    };
    add(names, "th");
    rows.forEach((row) => add(row, "td"));
    return made;
  };
  const number = (value, digits = 4, absent = "lost") => (value === null ? absent : value.toFixed(digits));
  const percent = (value) => (value === null ? "-" : (100 * value).toFixed(2) + " %");

  get("laws").append(
    table(
      ["law", "flights", "success", "95 % interval", "lost", "refused", "IAE 50 %, m s", "95 %", "99 %", "most 50 %, m", "95 %", "99 %"],
      summary.laws.map((law) => [
        law.law,
        String(law.flights),
        percent(law.success_rate),
        law.success_interval_95 === null ? "-" : law.success_interval_95.map(percent).join(" to "),
        String(law.lost),
        String(law.refused),
        ...[...law.iae_m_s, ...law.max_error_m].map((value) => number(value, 4, law.flights > 0 ? "lost" : "-")),
      ]),
    ),
  );
  distribution(get("iae"), laws, "iae_m_s", "IAE of the position, m s");
  distribution(get("most"), laws, "max_error_m", "largest position error, m");

  laws.forEach((law, i) => get("dots-law").append(new Option(law.law, i)));
  const drawMatters = () => {
    const which = Number(get("dots-law").value);
    const matters = summary.laws[which].matters;
    const canvas = get("matters");
    const c = canvas.getContext("2d");
    c.clearRect(0, 0, canvas.width, canvas.height);
    c.font = "13px system-ui, sans-serif";
    const middle = 0.62 * canvas.width;
    matters.slice(0, 12).forEach((matter, i) => {
      const y = 22 + 26 * i;
      c.fillStyle = matter.beyond_chance ? COLOURS[which % COLOURS.length] : "#c9ced4";
      c.fillRect(middle, y - 9, matter.explained * 0.36 * canvas.width, 14);
      c.fillStyle = "#1b1f24";
      c.textAlign = "left";
      const sign = matter.rank_correlation < 0 ? "\u2212" : "+";
      const correlation = sign + Math.abs(matter.rank_correlation).toFixed(2);
      c.fillText(`${matter.explained.toFixed(2)}  ${correlation}  ${matter.figure}`, 10, y + 3);
    });
    c.strokeStyle = "#9aa3ad";
    line(c, middle, 6, middle, canvas.height - 6);
  };
  const drawDots = () => {
    const which = Number(get("dots-law").value);
    const figure = Number(get("dots-figure").value);
    const dots = laws[which].dots.filter((dot) => dot[0].length);
    if (!dots.length) return;
    const xs = dots.map((dot) => dot[0][figure]);
    const most = Math.max(1e-3, ...dots.map((dot) => dot[1] || 0));
    const f = frame(get("dots"), {
      x: [Math.min(...xs), Math.max(...xs)],
      y: [0, 1.1 * most],
      xName: drawn[figure],
      yName: "largest error, m",
    });
    for (const [figures, error] of dots) {
      const [x, y] = [f.px(figures[figure]), error === null ? f.top + 6 : f.py(error)];
      f.c.fillStyle = f.c.strokeStyle = error === null ? "#c0392b" : COLOURS[which % COLOURS.length];
      if (error === null) {
        line(f.c, x - 3, y - 3, x + 3, y + 3);
        line(f.c, x - 3, y + 3, x + 3, y - 3);
      } else f.c.fillRect(x - 1.5, y - 1.5, 3, 3);
    }
  };
  const choose = () => {
    const matters = summary.laws[Number(get("dots-law").value)].matters;
    if (matters.length) get("dots-figure").value = String(drawn.indexOf(matters[0].figure));
    drawMatters();
    drawDots();
  };
  drawn.forEach((name, i) => get("dots-figure").append(new Option(name, i)));
  get("dots-law").addEventListener("change", choose);
  get("dots-figure").addEventListener("change", drawDots);
  if (laws.length && drawn.length) choose();

  get("worst").append(
    table(
      ["law", "run", "seed", "end", "again"],
      summary.laws.flatMap((law) =>
        law.worst.map((worst) => {
          const again = document.createElement("code");
          again.textContent = worst.replay;
          const end = worst.lost_s === null ? `${number(worst.max_error_m)} m` : `lost at ${worst.lost_s.toFixed(2)} s`;
          return [law.law, String(worst.run), String(worst.seed), end, again];
        }),
      ),
    ),
  );
  const replay = new Replay(DATA.flights);
  if (DATA.paper) {
    get("paper").hidden = false;
    get("paper-table").textContent = DATA.paper.table;
    for (const [title, svg] of DATA.paper.figures) {
      const image = document.createElement("img");
      image.alt = title;
      image.style.maxWidth = "100%";
      image.src = "data:image/svg+xml;charset=utf-8," + encodeURIComponent(svg);
      get("paper-figures").append(image);
    }
  }
  // A page that is asked to plays at once.
  if (location.hash === "#replay") replay.setPlaying(true);
  document.body.dataset.ready = "true";
})();
