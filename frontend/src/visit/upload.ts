/** Sending files in chunks; what a broken connection left behind is gone on with. */
import { changeHeaders, client, problemOf, unwrap, type Schemas } from "../api/client";

type Upload = Schemas["Upload"];

/** Files that say something to gaitlab: recordings and videos. */
export function isWanted(name: string): boolean {
  return /\.(c3d|mp4|webm|mov|pdf)$/i.test(name);
}

/** An open upload of the same file to the same visit. */
export function resumable(open: readonly Upload[], visit: string, file: { name: string; size: number }): Upload | undefined {
  return open.find((each) => each.session_id === visit && each.name === file.name && each.size === file.size);
}

async function sendChunk(upload: Upload, file: File): Promise<Upload> {
  const part = file.slice(upload.received, upload.received + upload.chunk_size);
  const response = await fetch(`/api/v1/uploads/${upload.id}/chunks/${upload.received}`, {
    method: "PUT",
    headers: { ...changeHeaders(), "Content-Type": "application/octet-stream" },
    body: part,
  });
  const told: unknown = await response.json();
  if (!response.ok) throw problemOf(told, response.status);
  return told as Upload;
}

/** Send one file; `onProgress` hears the part that is safe, 0 to 1. */
export async function send(visit: string, file: File, onProgress: (done: number) => void): Promise<void> {
  const open = await unwrap(client.GET("/api/v1/uploads"));
  const isRecording = /\.c3d$/i.test(file.name);
  let upload =
    resumable(open, visit, file) ??
    (await unwrap(
      client.POST("/api/v1/uploads", {
        body: {
          session_id: visit,
          name: file.name,
          size: file.size,
          media_type: (!isRecording && file.type) || "application/octet-stream",
        },
      }),
    ));
  while (upload.received < upload.size) {
    upload = await sendChunk(upload, file);
    onProgress(upload.received / upload.size);
  }
  await unwrap(client.POST("/api/v1/uploads/{upload_id}/finish", { params: { path: { upload_id: upload.id } } }));
}
