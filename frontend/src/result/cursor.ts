/** One position in the gait cycle, shared by all curves, the read-outs and the 3D view. */
import type uPlot from "uplot";

export type Listener = (percent: number | null) => void;

export class Cursor {
  percent: number | null = null;
  private readonly charts = new Set<uPlot>();
  private readonly listeners = new Set<Listener>();

  /** A chart that follows; the answer lets it go. */
  join(chart: uPlot): () => void {
    this.charts.add(chart);
    return () => this.charts.delete(chart);
  }

  listen(listener: Listener): () => void {
    this.listeners.add(listener);
    return () => this.listeners.delete(listener);
  }

  /** Move every chart but `source` and tell the listeners. */
  move(percent: number | null, source: uPlot | null): void {
    if (percent === this.percent) return;
    this.percent = percent;
    for (const chart of this.charts) if (chart !== source) place(chart, percent);
    for (const listener of this.listeners) listener(percent);
  }
}

function place(chart: uPlot, percent: number | null): void {
  const left = percent === null ? -10 : chart.valToPos(percent, "x");
  chart.setCursor({ left, top: percent === null ? -10 : 1 }, false);
}
