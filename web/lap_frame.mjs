// One boat's local frame on the picture: the axes that orders and observations are measured in.

/** Draws the outward and the clockwise axis of a boat, and the angle of its heading between them. */
export function drawLapFrame(scene, boat) {
  const { context, palette, run } = scene;
  const [x, y, heading] = scene.poses[boat];
  const [outward, length] = [Math.atan2(y, x), 5 * run.lengths.hull_radius_cm * scene.scale];
  const [left, top] = scene.pixelOf(boat);
  // Keeps words on the canvas.
  const inside = (position, origin, size, margin) => Math.min(Math.max(position, margin - origin), size - margin - origin);
  const write = (words, x, y) => {
    const position = [inside(x, left, scene.canvas.clientWidth, 32), inside(y, top, scene.canvas.clientHeight, 9)];
    label(context, palette, words, ...position);
  };
  context.save();
  context.translate(left, top);
  context.strokeStyle = context.fillStyle = palette.pin;
  context.lineWidth = 1.5;
  context.font = `12px ${getComputedStyle(document.body).fontFamily}`;
  context.textAlign = "center";
  context.textBaseline = "middle";
  for (const [angle, words] of [[outward, "outward"], [outward - Math.PI / 2, "clockwise"]]) {
    // The canvas has y downward, headings are counter-clockwise.
    const [cos, sin] = [Math.cos(angle), -Math.sin(angle)];
    context.beginPath();
    context.moveTo(0, 0);
    context.lineTo(length * cos, length * sin);
    context.lineTo(length * cos - 7 * (cos + 0.5 * sin), length * sin - 7 * (sin - 0.5 * cos));
    context.moveTo(length * cos, length * sin);
    context.lineTo(length * cos - 7 * (cos - 0.5 * sin), length * sin - 7 * (sin + 0.5 * cos));
    context.stroke();
    write(words, (length + 24) * cos, (length + 12) * sin);
  }
  const phi = Math.atan2(Math.sin(outward - heading), Math.cos(outward - heading));
  context.beginPath();
  context.arc(0, 0, 0.6 * length, -outward, -outward + phi, phi < 0);
  context.setLineDash([4, 3]);
  context.stroke();
  const middle = outward - phi / 2;
  write("φ", 0.6 * length * Math.cos(middle), -0.6 * length * Math.sin(middle));
  context.restore();
}

function label(context, palette, words, x, y) {
  context.lineWidth = 3;
  context.strokeStyle = palette.water;
  context.strokeText(words, x, y);
  context.lineWidth = 1.5;
  context.strokeStyle = palette.pin;
  context.fillText(words, x, y);
}
