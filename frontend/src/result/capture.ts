/** Pictures and videos of the 3D view, taken in this browser from the canvas of its page. */

const FRAMES_PER_SECOND = 30;
const KINDS = ["video/mp4", "video/webm"];

/** The canvas that three.js draws on, as it marks it itself; null while the page is not there yet. */
function canvasOf(frame: HTMLIFrameElement | null): HTMLCanvasElement | null {
  return frame?.contentDocument?.querySelector<HTMLCanvasElement>("canvas[data-engine]") ?? null;
}

function save(content: Blob, name: string): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(content);
  link.download = name;
  link.click();
  // After the browser has begun to read it.
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

/** Save what is seen; `redraw` makes the scene draw once more, as a canvas only tells of what is new. */
export async function saveStill(frame: HTMLIFrameElement | null, name: string, redraw: () => void): Promise<void> {
  const canvas = canvasOf(frame);
  if (!canvas) return;
  const stream = canvas.captureStream(FRAMES_PER_SECOND);
  const video = document.createElement("video");
  video.muted = true;
  video.srcObject = stream;
  const ready = new Promise((resolve) => (video.onloadeddata = resolve));
  redraw();
  await Promise.all([ready, video.play()]);
  const still = document.createElement("canvas");
  [still.width, still.height] = [video.videoWidth, video.videoHeight];
  still.getContext("2d")?.drawImage(video, 0, 0);
  for (const track of stream.getTracks()) track.stop();
  still.toBlob((content) => content && save(content, `${name}.png`));
}

/** Record until the answer is called, then save. */
export function record(frame: HTMLIFrameElement | null, name: string): () => void {
  const canvas = canvasOf(frame);
  const kind = KINDS.find((each) => MediaRecorder.isTypeSupported(each));
  if (!canvas || !kind) return () => undefined;
  const recorder = new MediaRecorder(canvas.captureStream(FRAMES_PER_SECOND), { mimeType: kind });
  const parts: Blob[] = [];
  recorder.ondataavailable = ({ data }) => parts.push(data);
  recorder.onstop = () => save(new Blob(parts, { type: kind }), `${name}.${kind.split("/")[1]}`);
  recorder.start();
  return () => recorder.stop();
}
