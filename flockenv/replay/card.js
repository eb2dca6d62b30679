// What a run's panel says in words: its legend in the corners, and a card with a boat's numbers.

/** An element with a class and text. */
function element(kind, className = "", text = "") {
  const made = document.createElement(kind);
  made.className = className;
  made.textContent = text;
  return made;
}

/** A number with a real minus sign; what rounds to zero has no sign. */
function fixed(value, decimals, plus = false) {
  if (value === undefined) {
    return "–";
  }
  const text = value.toFixed(decimals);
  if (Number(text) === 0) {
    return text.replace("-", "");
  }
  return text.startsWith("-") ? text.replace("-", "−") : (plus ? "+" : "") + text;
}

/** An angle within half a turn. */
function wrapped(angle) {
  return Math.atan2(Math.sin(angle), Math.cos(angle));
}

/** A run's canvas with everything around it. */
class Panel {
  constructor(run, place, several) {
    this.run = run;
    this.root = element("article", "run");
    this.root.dataset.run = String(place);
    const title = element("h2");
    const swatch = element("span", `swatch run-${place + 1}`);
    title.append(...(several ? [swatch] : []), element("span", "name", run.name),
      element("span", "faint facts", `seed ${run.seed} · flockenv ${run.version}`));
    this.picture = element("div", "picture");
    this.canvas = element("canvas");
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute("aria-label", `Boats of ${run.name}`);
    this.picture.append(this.canvas, this.#clock(), this.#task(), this.#order(), this.#signed());
    this.card = element("div", "card");
    this.card.hidden = true;
    this.picture.append(this.card);
    this.root.append(title, this.picture);
    this.scene = new Scene(this.canvas, run);
  }

  #clock() {
    const corner = element("div", "corner top left");
    this.time = element("div", "time");
    const phases = element("div", "phases");
    this.phases = this.run.phases.map((name) => element("span", "phase", name));
    phases.append(...this.phases);
    corner.append(this.time, phases);
    return corner;
  }

  #task() {
    const { run } = this;
    const corner = element("div", "corner top right");
    corner.append(element("div", "", run.target === "cw" ? "target ↻ cw" : "target ↺ ccw"),
      element("div", "", `bw ${fixed(run.bw_s, 2)} s`));
    if (run.leaders > 0) {
      const leaders = element("div");
      leaders.append(element("span", "swatch leader"),
        `${run.leaders} leader${run.leaders > 1 ? "s" : ""}`);
      corner.append(leaders);
    }
    return corner;
  }

  #order() {
    const corner = element("div", "corner bottom left");
    this.phi = element("span", "phi");
    this.psi = element("span", "psi");
    this.psiBar = element("div", "bar");
    const [angle, line, gauge] = [element("div"), element("div"), element("div", "gauge")];
    angle.append("angle φₒ ", this.phi, " rad");
    line.append("order Ψₒ ", this.psi);
    gauge.append(this.psiBar);
    corner.append(angle, line, gauge);
    return corner;
  }

  #signed() {
    const corner = element("div", "corner bottom right");
    this.signed = element("span", "signed");
    this.signedBar = element("div", "bar");
    const [line, gauge] = [element("div"), element("div", "gauge middle")];
    line.append("towards target ", this.signed);
    gauge.append(this.signedBar);
    corner.append(line, gauge);
    return corner;
  }

  show(time, options) {
    const { run } = this;
    const sample = run.sampleAt(time);
    this.root.dataset.sample = String(sample);
    this.scene.draw(time, options);
    this.time.textContent = `${fixed(run.time[sample], 1)} s`;
    const phase = run.phase(sample);
    this.phases.forEach((each) => each.classList.toggle("now", each.textContent === phase));
    this.psi.textContent = fixed(run.value("psi_o", sample), 2);
    this.phi.textContent = fixed(run.value("phi_o", sample), 2, true);
    const signed = run.value("signed_order", sample);
    this.signed.textContent = fixed(signed, 2, true);
    this.psiBar.style.width = `${100 * (run.value("psi_o", sample) ?? 0)}%`;
    this.signedBar.style.width = `${50 * Math.abs(signed ?? 0)}%`;
    this.signedBar.style.left = `${signed < 0 ? 50 + 50 * signed : 50}%`;
    this.signedBar.classList.toggle("against", signed < 0);
    this.#showCard(options.boat, sample);
  }

  #showCard(boat, sample) {
    const isShown = boat !== null && boat < this.run.boats;
    this.card.hidden = !isShown;
    if (!isShown) {
      return;
    }
    const head = element("div", "head", `boat ${boat}`);
    head.append(element("span", "faint", boat < this.run.leaders ? " leader" : ""));
    const list = element("dl");
    for (const [name, value, unit] of this.#numbers(boat, sample)) {
      const answer = element("dd", "", value);
      answer.dataset.number = name;
      list.append(element("dt", "", name), answer, element("dd", "faint", unit));
    }
    this.card.replaceChildren(head, list);
    const [x, y] = this.scene.place(boat);
    const [width, height] = [this.picture.clientWidth, this.picture.clientHeight];
    const beside = x > width / 2 ? x - this.card.offsetWidth - 18 : x + 18;
    this.card.style.left = `${Math.max(beside, 2)}px`;
    this.card.style.top = `${Math.min(Math.max(y - 30, 2), height - this.card.offsetHeight - 2)}px`;
  }

  #numbers(boat, sample) {
    const { run } = this;
    const at = (name, channel) => run.columns.get(name).at(sample, channel);
    const numbers = [
      ["x", fixed(at("position_cm", 2 * boat), 1), "cm"],
      ["y", fixed(at("position_cm", 2 * boat + 1), 1), "cm"],
      ["heading", fixed(wrapped(at("heading", boat)), 2), "rad"],
      ["speed", fixed(at("speed_cm_s", boat), 1), "cm/s"],
      ["turning", fixed(at("turning_rate", boat), 2, true), "rad/s"],
    ];
    if (run.hasForces) {
      const touching = run.contacts(sample).filter(({ i, j }) => i === boat || j === boat);
      const strongest = Math.max(0, ...touching.map(({ force }) => force));
      numbers.push(["contacts", String(touching.length), ""]);
      numbers.push(["strongest push", fixed(strongest, 1), "cm/s²"]);
    }
    return numbers;
  }
}
