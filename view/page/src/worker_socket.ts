/** A server in a Web Worker of this page, with what the page uses of a WebSocket. */
export class WorkerSocket {
  readyState: number = WebSocket.CONNECTING;
  binaryType = "arraybuffer";
  onopen?: () => void;
  onmessage?: (event: { data: string | ArrayBuffer }) => void;
  onclose?: () => void;
  private readonly worker: Worker;

  constructor(address: string) {
    this.worker = new Worker(address);
    this.worker.onmessage = ({ data }) => {
      if (data !== "open") return this.onmessage?.({ data });
      this.readyState = WebSocket.OPEN;
      this.onopen?.();
    };
    this.worker.onerror = () => {
      this.worker.terminate();
      this.readyState = WebSocket.CLOSED;
      this.onclose?.();
    };
  }

  send(data: string | DataView) {
    this.worker.postMessage(data);
  }
}
