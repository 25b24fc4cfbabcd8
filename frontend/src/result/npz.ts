/** Arrays of an .npz file: a zip of numpy arrays. */

export interface NumberArray {
  shape: readonly number[];
  /** Row by row. */
  values: Float64Array;
}

export interface Arrays {
  numbers: ReadonlyMap<string, NumberArray>;
  texts: ReadonlyMap<string, readonly string[]>;
}

const END_OF_DIRECTORY = 0x06054b50;
const DEFLATED = 8;

interface Entry {
  name: string;
  method: number;
  size: number;
  offset: number;
}

function entriesOf(view: DataView): Entry[] {
  let end = view.byteLength - 22;
  while (end >= 0 && view.getUint32(end, true) !== END_OF_DIRECTORY) end -= 1;
  if (end < 0) throw new Error("no zip: its directory is missing");
  const count = view.getUint16(end + 10, true);
  const entries: Entry[] = [];
  for (let at = view.getUint32(end + 16, true), index = 0; index < count; index += 1) {
    const length = view.getUint16(at + 28, true);
    const name = new TextDecoder().decode(new Uint8Array(view.buffer, view.byteOffset + at + 46, length));
    const method = view.getUint16(at + 10, true);
    entries.push({ name, method, size: view.getUint32(at + 20, true), offset: view.getUint32(at + 42, true) });
    at += 46 + length + view.getUint16(at + 30, true) + view.getUint16(at + 32, true);
  }
  return entries;
}

async function contentOf(view: DataView, { method, size, offset }: Entry): Promise<ArrayBuffer> {
  // The local header's own lengths: its extra field differs from the directory's.
  const begin = view.byteOffset + offset + 30 + view.getUint16(offset + 26, true) + view.getUint16(offset + 28, true);
  const packed = view.buffer.slice(begin, begin + size) as ArrayBuffer;
  if (method !== DEFLATED) return packed;
  return new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate-raw"))).arrayBuffer();
}

function letters(content: ArrayBuffer, begin: number, length: number, count: number): string[] {
  const codes = new Uint32Array(content.slice(begin, begin + 4 * length * count));
  return Array.from({ length: count }, (_, index) =>
    String.fromCodePoint(...codes.subarray(index * length, (index + 1) * length)).replaceAll("\0", ""),
  );
}

function decode(content: ArrayBuffer): NumberArray | readonly string[] | null {
  const view = new DataView(content);
  const long = view.getUint8(6) > 1;
  const begin = long ? 12 + view.getUint32(8, true) : 10 + view.getUint16(8, true);
  const header = new TextDecoder().decode(content.slice(long ? 12 : 10, begin));
  const kind = /'descr': '([^']+)'/.exec(header)?.[1] ?? "";
  const shape = (/'shape': \(([^)]*)\)/.exec(header)?.[1] ?? "").split(",").filter((part) => part.trim()).map(Number);
  const count = shape.reduce((product, length) => product * length, 1);
  if (header.includes("'fortran_order': True")) return null;
  if (kind.startsWith("<U")) return letters(content, begin, Number(kind.slice(2)), count);
  if (kind === "<f8") return { shape, values: new Float64Array(content.slice(begin, begin + 8 * count)) };
  if (kind === "<i8") {
    const whole = new BigInt64Array(content.slice(begin, begin + 8 * count));
    return { shape, values: Float64Array.from(whole, Number) };
  }
  return null;
}

/** Arrays of these names that are in the file; of numbers (float64, int64) or of texts. */
export async function readNpz(file: ArrayBuffer, names: readonly string[]): Promise<Arrays> {
  const view = new DataView(file);
  const numbers = new Map<string, NumberArray>();
  const texts = new Map<string, readonly string[]>();
  for (const entry of entriesOf(view)) {
    const name = entry.name.replace(/\.npy$/, "");
    const array = names.includes(name) ? decode(await contentOf(view, entry)) : null;
    if (array && "shape" in array) numbers.set(name, array);
    else if (array) texts.set(name, array);
  }
  return { numbers, texts };
}
