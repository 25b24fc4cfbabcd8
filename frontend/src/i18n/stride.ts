/** Strides as the server names them, such as "left stride at 1.56 s" or "left 1.56 s". */

export interface NamedStride {
  /** What comes before the stride, without its comma. */
  before: string;
  side: "left" | "right";
  start_s: number;
}

const STRIDE = /^(?:(.*), )?(left|right) (?:stride at )?([\d.]+) s$/;

/** The parts of a text that ends with a stride; null where it does not. */
export function strideIn(text: string): NamedStride | null {
  const [, before, side, start] = STRIDE.exec(text) ?? [];
  return side && start ? { before: before ?? "", side: side as NamedStride["side"], start_s: Number(start) } : null;
}
