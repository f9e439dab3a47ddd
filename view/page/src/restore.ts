/**
 * Notices that the page has reconnected to a server which was started anew, with another scenario. The page then asks
 * what to do, instead of replacing the user's scenario and address.
 */
export class Restore {
  private session = "";
  private mine = "";
  private readonly box = document.getElementById("restore")!;

  /** `apply`: sets the scenario of an address (what follows the #). */
  constructor(private readonly apply: (address: string) => void, private readonly decided: () => void) {
    const on = (id: string, act: () => void) => (document.getElementById(id)!.onclick = () => { this.box.hidden = true; act(); });
    on("restore-mine", () => this.apply(this.mine));
    on("restore-not", () => this.decided());
  }

  /** Whether the user has not decided yet. */
  get isOpen() { return !this.box.hidden; }

  /** A server has greeted the page, whose address is `address`. */
  greeted(session: string, address: string) {
    if (this.session && session !== this.session) {
      if (!this.isOpen) this.mine = address;
      this.box.hidden = !this.mine;
    }
    this.session = session;
  }

  /** What the server drives: nothing is to be decided where that is the user's scenario. */
  showServer(address: string) {
    if (this.isOpen && address === this.mine) { this.box.hidden = true; this.decided(); }
  }
}
