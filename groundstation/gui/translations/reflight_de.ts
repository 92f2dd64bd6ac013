<?xml version="1.0" encoding="utf-8"?>
<!DOCTYPE TS>
<TS version="2.1" language="de_DE">
<context>
    <name>AfterFlight</name>
    <message>
        <source>Nothing is missing: the photos show all that was planned.</source>
        <translation>Nichts fehlt: Die Fotos zeigen alles, was geplant war.</translation>
    </message>
    <message>
        <source>Top-up planned, photos: {0}; it closes {1} of {2} missing sections</source>
        <translation>Ergänzungsflug geplant, Fotos: {0}; er schließt {1} von {2} fehlenden Sektoren</translation>
    </message>
    <message>
        <source>Fly it before the battery is changed.</source>
        <translation>Zu fliegen, bevor der Akku gewechselt wird.</translation>
    </message>
    <message>
        <source>Fly the first sortie before the battery is changed, the others with full ones.</source>
        <translation>Den ersten Einsatz fliegen, bevor der Akku gewechselt wird, die übrigen mit vollen.</translation>
    </message>
    <message>
        <source>It needs a full battery: change it first.</source>
        <translation>Es braucht einen vollen Akku: zuerst wechseln.</translation>
    </message>
    <message>
        <source>Top-up</source>
        <translation>Ergänzung</translation>
    </message>
    <message>
        <source>{0}. {1}</source>
        <translation>{0}. {1}</translation>
    </message>
    <message>
        <source>Top-up flight</source>
        <translation>Ergänzungsflug</translation>
    </message>
    <message>
        <source>Rest of sortie {0} planned, photos: {1}. It needs a full battery: change it first.</source>
        <translation>Rest von Einsatz {0} geplant, Fotos: {1}. Er braucht einen vollen Akku: zuerst wechseln.</translation>
    </message>
    <message>
        <source>Rest of sortie {0}</source>
        <translation>Rest von Einsatz {0}</translation>
    </message>
    <message>
        <source>Resume sortie</source>
        <translation>Einsatz fortsetzen</translation>
    </message>
    <message>
        <source>This flight was over the site {0}: open its project first.</source>
        <translation>Dieser Flug war über dem Standort {0}: zuerst dessen Projekt öffnen.</translation>
    </message>
</context>
<context>
    <name>AircraftBox</name>
    <message>
        <source>From a file ...</source>
        <translation>Aus Datei ...</translation>
    </message>
    <message>
        <source>Aircraft and camera</source>
        <translation>Fluggerät und Kamera</translation>
    </message>
    <message>
        <source>Aircraft (*.toml)</source>
        <translation>Fluggeräte (*.toml)</translation>
    </message>
</context>
<context>
    <name>AirspacePage</name>
    <message>
        <source>Airspace</source>
        <translation>Luftraum</translation>
    </message>
    <message>
        <source>Ground</source>
        <translation>Boden</translation>
    </message>
    <message>
        <source>Heights are above the site origin. Only the climb above home may be below the airspace.</source>
        <translation>Höhen zählen ab dem Nullpunkt des Standorts. Nur der Aufstieg über dem Startplatz darf unter dem Luftraum liegen.</translation>
    </message>
    <message>
        <source>Change airspace</source>
        <translation>Luftraum ändern</translation>
    </message>
</context>
<context>
    <name>AnsweringDialog</name>
    <message>
        <source>Close</source>
        <translation>Schließen</translation>
    </message>
</context>
<context>
    <name>ApplicationContext</name>
    <message>
        <source>{0}: cancelled</source>
        <translation>{0}: abgebrochen</translation>
    </message>
    <message>
        <source>{0}: {1}</source>
        <translation>{0}: {1}</translation>
    </message>
    <message>
        <source>{0}: Reflight failed where it should not ({1}: {2}); please report it</source>
        <translation>{0}: Reflight versagte, wo es nicht darf ({1}: {2}); bitte melden</translation>
    </message>
</context>
<context>
    <name>AttitudeView</name>
    <message>
        <source>Attitude and heading</source>
        <translation>Lage und Kurs</translation>
    </message>
    <message>
        <source>heading {0:03.0f}°, pitch {1:+.0f}°, roll {2:+.0f}°</source>
        <translation>Kurs {0:03.0f}°, Nicken {1:+.0f}°, Rollen {2:+.0f}°</translation>
    </message>
    <message>
        <source>cam {0:+.0f}°</source>
        <translation>Kam. {0:+.0f}°</translation>
    </message>
</context>
<context>
    <name>Axes</name>
    <message>
        <source>East</source>
        <translation>Ost</translation>
    </message>
    <message>
        <source>North</source>
        <translation>Nord</translation>
    </message>
    <message>
        <source>Up</source>
        <translation>Höhe</translation>
    </message>
</context>
<context>
    <name>Brief</name>
    <message>
        <source>Page {0} of {1}</source>
        <translation>Seite {0} von {1}</translation>
    </message>
    <message>
        <source>height above take-off [{0}]</source>
        <translation>Höhe über Start [{0}]</translation>
    </message>
    <message>
        <source>time [min]</source>
        <translation>Zeit [min]</translation>
    </message>
    <message>
        <source>Flight brief: {0}</source>
        <translation>Flugbriefing: {0}</translation>
    </message>
    <message>
        <source>Take-off and landing</source>
        <translation>Start und Landung</translation>
    </message>
    <message>
        <source>Sorties</source>
        <translation>Einsätze</translation>
    </message>
    <message>
        <source>Set on the remote controller</source>
        <translation>An der Fernsteuerung einstellen</translation>
    </message>
    <message>
        <source>Findings</source>
        <translation>Befunde</translation>
    </message>
    <message>
        <source>Before take-off</source>
        <translation>Vor dem Start</translation>
    </message>
    <message>
        <source>Map</source>
        <translation>Karte</translation>
    </message>
    <message>
        <source>Height of sortie {0}</source>
        <translation>Höhe von Einsatz {0}</translation>
    </message>
    <message>
        <source>All pre-flight rules are kept: ready to fly.</source>
        <translation>Alle Regeln vor dem Flug sind eingehalten: flugbereit.</translation>
    </message>
    <message>
        <source>Ready to fly, but read the warnings.</source>
        <translation>Flugbereit, aber Warnungen lesen.</translation>
    </message>
    <message>
        <source>NOT ready to fly: see the findings.</source>
        <translation>NICHT flugbereit: siehe Befunde.</translation>
    </message>
    <message>
        <source>Date</source>
        <translation>Datum</translation>
    </message>
    <message>
        <source>Plan</source>
        <translation>Plan</translation>
    </message>
    <message>
        <source>Aircraft and camera</source>
        <translation>Fluggerät und Kamera</translation>
    </message>
    <message>
        <source>Photos</source>
        <translation>Fotos</translation>
    </message>
    <message>
        <source>Batteries needed</source>
        <translation>Benötigte Akkus</translation>
    </message>
    <message>
        <source>Flight time, all sorties</source>
        <translation>Flugzeit, alle Einsätze</translation>
    </message>
    <message>
        <source>{0}; {1} below {2}</source>
        <translation>{0}; {1} unter {2}</translation>
    </message>
    <message>
        <source>at most {0}</source>
        <translation>höchstens {0}</translation>
    </message>
    <message>
        <source>Sun</source>
        <translation>Sonne</translation>
    </message>
    <message>
        <source>Tall, half, low: facades in the sun, in part, in shade; take-offs that spoil no, few, many photos</source>
        <translation>Hoch, halb, niedrig: Fassaden in der Sonne, zum Teil, im Schatten; Starts, die keine, wenige, viele Fotos verderben</translation>
    </message>
    <message>
        <source>Planned for</source>
        <translation>Geplant für</translation>
    </message>
    <message>
        <source>Temperature</source>
        <translation>Temperatur</translation>
    </message>
    <message>
        <source>Directions of view seen, of those possible</source>
        <translation>Gesehene Blickrichtungen, von den möglichen</translation>
    </message>
    <message>
        <source>Unseen views of the model, expected, by batteries</source>
        <translation>Ungesehene Ansichten des Modells, erwartet, nach Akkus</translation>
    </message>
    <message>
        <source>Another battery would bring</source>
        <translation>Ein weiterer Akku brächte</translation>
    </message>
    <message>
        <source>Pixel on the panel</source>
        <translation>Pixel auf der Scheibe</translation>
    </message>
    <message>
        <source>{0} of what is covered with up to {1}, the coarsest with {2}</source>
        <translation>{0} des Abgedeckten mit bis zu {1}, das gröbste mit {2}</translation>
    </message>
    <message>
        <source>{0} to {1}, at least {2} to be kept but at take-off</source>
        <translation>{0} bis {1}, einzuhalten sind außer beim Start mindestens {2}</translation>
    </message>
    <message>
        <source>Nobody walks and nothing stands or hangs where the paths come down to {0} above the ground</source>
        <translation>Niemand geht und nichts steht oder hängt dort, wo die Flugwege bis auf {0} über Boden herabkommen</translation>
    </message>
    <message>
        <source>{0} along the paths, {1} to be kept</source>
        <translation>{0} entlang der Flugwege, {1} einzuhalten</translation>
    </message>
    <message>
        <source>not measured</source>
        <translation>nicht gemessen</translation>
    </message>
    <message>
        <source>Smallest distance to building and obstacles</source>
        <translation>Kleinster Abstand zu Gebäude und Hindernissen</translation>
    </message>
    <message>
        <source>planned for {0}, the aircraft may fly below {1}</source>
        <translation>geplant für {0}, das Fluggerät darf unter {1} fliegen</translation>
    </message>
    <message>
        <source>Wind</source>
        <translation>Wind</translation>
    </message>
    <message>
        <source>Ground risk (SORA 2.5, a draft)</source>
        <translation>Bodenrisiko (SORA 2.5, ein Entwurf)</translation>
    </message>
    <message>
        <source>Uninvolved people inside the buffer</source>
        <translation>Unbeteiligte im Puffer</translation>
    </message>
    <message>
        <source>contingency volume {0} to each side, up to {1} above ground; ground-risk buffer {2} beyond</source>
        <translation>Notfallvolumen {0} zu jeder Seite, bis {1} über Grund; Bodenrisikopuffer {2} darüber hinaus</translation>
    </message>
    <message>
        <source>{0}; class {1}</source>
        <translation>{0}; Klasse {1}</translation>
    </message>
    <message>
        <source>not stated how many: keep everybody out</source>
        <translation>nicht angegeben, wie viele: halten Sie alle fern</translation>
    </message>
    <message>
        <source>none: controlled ground area</source>
        <translation>keine: kontrollierter Bodenbereich</translation>
    </message>
    <message>
        <source>an assembly of people</source>
        <translation>eine Menschenansammlung</translation>
    </message>
    <message>
        <source>fewer than {0} per square kilometre</source>
        <translation>weniger als {0} je Quadratkilometer</translation>
    </message>
    <message>
        <source>Position (WGS 84)</source>
        <translation>Position (WGS 84)</translation>
    </message>
    <message>
        <source>Height above sea level (EGM96)</source>
        <translation>Höhe über Meer (EGM96)</translation>
    </message>
    <message>
        <source>Height above the ellipsoid (WGS 84)</source>
        <translation>Höhe über Ellipsoid (WGS 84)</translation>
    </message>
    <message>
        <source>Height above ground</source>
        <translation>Höhe über Boden</translation>
    </message>
    <message>
        <source>Sortie</source>
        <translation>Einsatz</translation>
    </message>
    <message>
        <source>Time [min]</source>
        <translation>Zeit [min]</translation>
    </message>
    <message>
        <source>Length</source>
        <translation>Flugweg</translation>
    </message>
    <message>
        <source>Battery used</source>
        <translation>Akkuverbrauch</translation>
    </message>
    <message>
        <source>Highest above take-off</source>
        <translation>Höchster Punkt über Start</translation>
    </message>
    <message>
        <source>Highest above sea (EGM96)</source>
        <translation>Höchster Punkt über Meer (EGM96)</translation>
    </message>
    <message>
        <source>Smallest distance</source>
        <translation>Kleinster Abstand</translation>
    </message>
    <message>
        <source>The plan has no sorties.</source>
        <translation>Der Plan hat keine Einsätze.</translation>
    </message>
    <message>
        <source>Return height, above take-off</source>
        <translation>Rückkehrhöhe, über Start</translation>
    </message>
    <message>
        <source>not known</source>
        <translation>unbekannt</translation>
    </message>
    <message>
        <source>continue mission</source>
        <translation>Mission fortsetzen</translation>
    </message>
    <message>
        <source>return home straight, at the return height</source>
        <translation>direkt zum Startplatz zurück, in Rückkehrhöhe</translation>
    </message>
    <message>
        <source>Without radio link</source>
        <translation>Ohne Funkverbindung</translation>
    </message>
    <message>
        <source>Battery reserve at landing</source>
        <translation>Akkureserve bei der Landung</translation>
    </message>
    <message>
        <source>Highest speed</source>
        <translation>Höchste Geschwindigkeit</translation>
    </message>
    <message>
        <source>Hover before each photo</source>
        <translation>Halt vor jedem Foto</translation>
    </message>
    <message>
        <source>None: every rule is kept.</source>
        <translation>Keine: Jede Regel ist eingehalten.</translation>
    </message>
    <message>
        <source>ERROR</source>
        <translation>FEHLER</translation>
    </message>
    <message>
        <source>Warning</source>
        <translation>Warnung</translation>
    </message>
    <message>
        <source>Note</source>
        <translation>Hinweis</translation>
    </message>
    <message>
        <source>Severity</source>
        <translation>Stufe</translation>
    </message>
    <message>
        <source>Finding</source>
        <translation>Befund</translation>
    </message>
    <message>
        <source>Measured</source>
        <translation>Gemessen</translation>
    </message>
    <message>
        <source>Place</source>
        <translation>Ort</translation>
    </message>
    <message>
        <source>Permission for this place and height is at hand; nobody is below the paths</source>
        <translation>Genehmigung für diesen Ort und diese Höhe liegt vor; niemand ist unter den Flugwegen</translation>
    </message>
    <message>
        <source>No-fly zones known to everybody: {0}</source>
        <translation>Flugverbotszonen, allen bekannt: {0}</translation>
    </message>
    <message>
        <source>none</source>
        <translation>keine</translation>
    </message>
    <message>
        <source>Nothing stands within {0} of the paths but what the site knows (building; obstacles: {1})</source>
        <translation>Innerhalb von {0} um die Flugwege steht nur, was der Standort kennt (Gebäude; Hindernisse: {1})</translation>
    </message>
    <message>
        <source>Fully charged batteries: {0}; free space for photos: {1}</source>
        <translation>Voll geladene Akkus: {0}; freier Speicher für Fotos: {1}</translation>
    </message>
    <message>
        <source>Aircraft stands on the take-off point; GNSS (RTK where there is one) has a fix, compass is calibrated</source>
        <translation>Fluggerät steht auf dem Startplatz; GNSS (RTK, falls vorhanden) hat einen Fix, Kompass ist kalibriert</translation>
    </message>
    <message>
        <source>Return height on the remote controller is at least {0} above take-off</source>
        <translation>Rückkehrhöhe an der Fernsteuerung ist mindestens {0} über Start</translation>
    </message>
    <message>
        <source>Wind at flight height is below {0}</source>
        <translation>Wind in Flughöhe ist unter {0}</translation>
    </message>
    <message>
        <source>The mission on the remote controller is this plan (photos: {0})</source>
        <translation>Die Mission auf der Fernsteuerung ist dieser Plan (Fotos: {0})</translation>
    </message>
    <message>
        <source>Focus, exposure and white balance are fixed on the facade</source>
        <translation>Fokus, Belichtung und Weißabgleich sind auf der Fassade fest eingestellt</translation>
    </message>
    <message>
        <source>Sortie {0}: before any photo the aircraft stops {1}. Where it does not, land: it took off from another height than planned</source>
        <translation>Einsatz {0}: Vor jedem Foto hält das Fluggerät {1} an. Wo nicht, landen: Es ist von einer anderen Höhe als geplant gestartet</translation>
    </message>
    <message>
        <source>{0} above take-off</source>
        <translation>{0} über dem Startplatz</translation>
    </message>
    <message>
        <source>{0} above {1}</source>
        <translation>{0} über {1}</translation>
    </message>
    <message>
        <source>{0} below {1}</source>
        <translation>{0} unter {1}</translation>
    </message>
    <message>
        <source>the upper edge of facade {0}</source>
        <translation>der Oberkante der Fassade {0}</translation>
    </message>
    <message>
        <source>the lower edge of facade {0}</source>
        <translation>der Unterkante der Fassade {0}</translation>
    </message>
</context>
<context>
    <name>BriefDialog</name>
    <message>
        <source>Flight brief</source>
        <translation>Flugbriefing</translation>
    </message>
    <message>
        <source>A4</source>
        <translation>A4</translation>
    </message>
    <message>
        <source>US Letter</source>
        <translation>US Letter</translation>
    </message>
    <message>
        <source>Save as PDF ...</source>
        <translation>Als PDF speichern ...</translation>
    </message>
    <message>
        <source>Print ...</source>
        <translation>Drucken ...</translation>
    </message>
    <message>
        <source>Close</source>
        <translation>Schließen</translation>
    </message>
    <message>
        <source>Paper</source>
        <translation>Papier</translation>
    </message>
    <message>
        <source>Drawing the map and the profiles ...</source>
        <translation>Karte und Profile werden gezeichnet ...</translation>
    </message>
    <message>
        <source>Written: {0}</source>
        <translation>Geschrieben: {0}</translation>
    </message>
    <message>
        <source>Save the flight brief</source>
        <translation>Flugbriefing speichern</translation>
    </message>
    <message>
        <source>PDF (*.pdf)</source>
        <translation>PDF (*.pdf)</translation>
    </message>
</context>
<context>
    <name>CameraPreview</name>
    <message>
        <source>Play</source>
        <translation>Abspielen</translation>
    </message>
    <message>
        <source>Fly through the sortie (space bar)</source>
        <translation>Den Einsatz abfliegen (Leertaste)</translation>
    </message>
    <message>
        <source>The sortie that is flown</source>
        <translation>Der Einsatz, der abgeflogen wird</translation>
    </message>
    <message>
        <source>How many times faster than the flight</source>
        <translation>Um wie viel schneller als der Flug</translation>
    </message>
    <message>
        <source>{0}x</source>
        <translation>{0}x</translation>
    </message>
    <message>
        <source>No plan yet: make or open one, then choose a viewpoint.</source>
        <translation>Noch kein Plan: einen erstellen oder öffnen, dann einen Aufnahmepunkt wählen.</translation>
    </message>
    <message>
        <source>{0}: covers no panel</source>
        <translation>{0}: deckt keine Scheibe ab</translation>
    </message>
    <message>
        <source>{0}: covers {1} panels
{2}</source>
        <translation>{0}: abgedeckte Scheiben: {1}
{2}</translation>
    </message>
    <message>
        <source>before the first photo</source>
        <translation>vor dem ersten Foto</translation>
    </message>
    <message>
        <source>on the way from {0}</source>
        <translation>unterwegs ab {0}</translation>
    </message>
    <message>
        <source>nearest panel {0}: {1} away, {2} per pixel, seen at {3:.0f}° from its normal
picture at this distance: {4} x {5}</source>
        <translation>nächste Scheibe {0}: {1} entfernt, {2} je Pixel, gesehen {3:.0f}° neben ihrer Normalen
Bild in dieser Entfernung: {4} x {5}</translation>
    </message>
    <message>
        <source>Sortie {0}</source>
        <translation>Einsatz {0}</translation>
    </message>
    <message>
        <source>The path of this sortie misses one of its viewpoints.</source>
        <translation>Der Flugweg dieses Einsatzes verfehlt einen seiner Aufnahmepunkte.</translation>
    </message>
    <message>
        <source>Pause</source>
        <translation>Pause</translation>
    </message>
    <message>
        <source>Time of the sortie</source>
        <translation>Zeit im Einsatz</translation>
    </message>
    <message>
        <source>{0} of {1}</source>
        <translation>{0} aus {1}</translation>
    </message>
</context>
<context>
    <name>ChoiceForm</name>
    <message>
        <source> min</source>
        <translation> min</translation>
    </message>
    <message>
        <source>At most</source>
        <translation>Höchstens</translation>
    </message>
    <message>
        <source>Custom time</source>
        <translation>eigene Zeit</translation>
    </message>
</context>
<context>
    <name>ChoiceSide</name>
    <message>
        <source>Choose ...</source>
        <translation>Wählen ...</translation>
    </message>
    <message>
        <source>Train</source>
        <translation>Trainieren</translation>
    </message>
    <message>
        <source>Pause</source>
        <translation>Anhalten</translation>
    </message>
    <message>
        <source>Resume</source>
        <translation>Fortsetzen</translation>
    </message>
    <message>
        <source>The data set is being read ...</source>
        <translation>Der Datensatz wird gelesen ...</translation>
    </message>
    <message>
        <source>None is chosen.</source>
        <translation>Keiner ist gewählt.</translation>
    </message>
    <message>
        <source>{0}: {1} photos, {2} panels</source>
        <translation>{0}: {1} Fotos, {2} Scheiben</translation>
    </message>
    <message>
        <source>Stop and keep</source>
        <translation>Stopp, behalten</translation>
    </message>
    <message>
        <source>Cancel</source>
        <translation>Abbrechen</translation>
    </message>
    <message>
        <source>A training was cancelled there: it can be resumed, as it was begun.</source>
        <translation>Dort wurde ein Training abgebrochen: es kann fortgesetzt werden, wie es begonnen wurde.</translation>
    </message>
    <message>
        <source>A finished model stands there. It stays until the new one is whole, and is replaced then.</source>
        <translation>Dort steht ein fertiges Modell. Es bleibt, bis das neue vollständig ist, und wird dann ersetzt.</translation>
    </message>
    <message>
        <source>There is something else in this folder; it is left alone.</source>
        <translation>In diesem Ordner ist etwas anderes; es bleibt unberührt.</translation>
    </message>
    <message>
        <source>Let the training wait; the model can be looked at meanwhile</source>
        <translation>Das Training warten lassen; das Modell kann inzwischen angesehen werden</translation>
    </message>
    <message>
        <source>Let the rates fall within a twentieth of the time so far, a minute at most, and write the model: it is better than it is now</source>
        <translation>Die Lernraten innerhalb eines Zwanzigstels der bisherigen Zeit fallen lassen, höchstens eine Minute, und das Modell schreiben: es wird besser, als es jetzt ist</translation>
    </message>
    <message>
        <source>End now and keep the state; the training can be gone on with later</source>
        <translation>Jetzt beenden und den Stand behalten; das Training kann später fortgesetzt werden</translation>
    </message>
    <message>
        <source>Data set</source>
        <translation>Datensatz</translation>
    </message>
    <message>
        <source>Model goes to</source>
        <translation>Modell kommt nach</translation>
    </message>
</context>
<context>
    <name>ClearanceChart</name>
    <message>
        <source>Sortie {0}</source>
        <translation>Einsatz {0}</translation>
    </message>
    <message>
        <source>distance flown in {0}</source>
        <translation>Flugweg in {0}</translation>
    </message>
    <message>
        <source>in {0}</source>
        <translation>in {0}</translation>
    </message>
    <message>
        <source>No route to measure yet.</source>
        <translation>Noch keine Route zum Messen.</translation>
    </message>
    <message>
        <source>Smallest clearance {0} (must be {1}); further than {2} is cut off</source>
        <translation>Kleinster Abstand {0} (Soll {1}); über {2} abgeschnitten</translation>
    </message>
    <message>
        <source>; from no-fly volumes {0} (dotted)</source>
        <translation>; zu Flugverbotszonen {0} (gepunktet)</translation>
    </message>
</context>
<context>
    <name>CompareWindow</name>
    <message>
        <source>Compare plans</source>
        <translation>Pläne vergleichen</translation>
    </message>
    <message>
        <source>coverage</source>
        <translation>Abdeckung</translation>
    </message>
    <message>
        <source>difference in coverage</source>
        <translation>Unterschied der Abdeckung</translation>
    </message>
    <message>
        <source>Panels by</source>
        <translation>Scheiben nach</translation>
    </message>
    <message>
        <source>Plans compared</source>
        <translation>Verglichene Pläne</translation>
    </message>
    <message>
        <source>auto</source>
        <translation>auto</translation>
    </message>
    <message>
        <source>on</source>
        <translation>an</translation>
    </message>
    <message>
        <source>off</source>
        <translation>aus</translation>
    </message>
    <message>
        <source>All plans judged with {0:g} degree sections, {1}, occlusion {2}. A star marks the better.</source>
        <translation>Alle Pläne beurteilt mit Sektoren von {0:g} Grad, {1}, Verdeckung {2}. Ein Stern markiert den besseren.</translation>
    </message>
    <message>
        <source>{0:.1f} s</source>
        <translation>{0:.1f} s</translation>
    </message>
    <message>
        <source>Views</source>
        <translation>Aufnahmen</translation>
    </message>
    <message>
        <source>Sorties</source>
        <translation>Einsätze</translation>
    </message>
    <message>
        <source>Time in the air</source>
        <translation>Zeit in der Luft</translation>
    </message>
    <message>
        <source>Coarsest GSD</source>
        <translation>Gröbste GSD</translation>
    </message>
    <message>
        <source>GSD</source>
        <translation>GSD</translation>
    </message>
    <message>
        <source>Distance</source>
        <translation>Strecke</translation>
    </message>
    <message>
        <source>Views found after</source>
        <translation>Aufnahmen gefunden nach</translation>
    </message>
    <message>
        <source>Sections covered</source>
        <translation>Abgedeckte Sektoren</translation>
    </message>
    <message>
        <source>of all sections</source>
        <translation>von allen Sektoren</translation>
    </message>
    <message>
        <source>of what can be covered</source>
        <translation>vom Erreichbaren</translation>
    </message>
    <message>
        <source>Facade {0}, of what can be covered</source>
        <translation>Fassade {0}, vom Erreichbaren</translation>
    </message>
    <message>
        <source>Sections no other plan covers</source>
        <translation>Sektoren nur in diesem Plan</translation>
    </message>
    <message>
        <source>Covered at least {0} times</source>
        <translation>Mindestens {0}-mal abgedeckt</translation>
    </message>
    <message>
        <source>Finest pixel</source>
        <translation>Feinstes Pixel</translation>
    </message>
    <message>
        <source>Finest pixel on the worst panel</source>
        <translation>Feinstes Pixel der schlechtesten Scheibe</translation>
    </message>
    <message>
        <source>Smallest clearance</source>
        <translation>Kleinster Abstand</translation>
    </message>
    <message>
        <source>Findings: {0}</source>
        <translation>Befunde: {0}</translation>
    </message>
    <message>
        <source>Covered of what is possible</source>
        <translation>Abgedeckt vom Erreichbaren</translation>
    </message>
    <message>
        <source>Sections more than the other</source>
        <translation>Sektoren mehr als der andere</translation>
    </message>
</context>
<context>
    <name>ComparisonView</name>
    <message>
        <source>Also what is the same</source>
        <translation>Auch Gleiches zeigen</translation>
    </message>
    <message>
        <source>Differences</source>
        <translation>Unterschiede</translation>
    </message>
    <message>
        <source>Photo</source>
        <translation>Foto</translation>
    </message>
    <message>
        <source>Viewpoint</source>
        <translation>Aufnahmepunkt</translation>
    </message>
    <message>
        <source>Sortie</source>
        <translation>Einsatz</translation>
    </message>
    <message>
        <source>In the file</source>
        <translation>In der Datei</translation>
    </message>
    <message>
        <source>Moved [{0}]</source>
        <translation>Verschoben [{0}]</translation>
    </message>
    <message>
        <source>Turned [°]</source>
        <translation>Gedreht [°]</translation>
    </message>
    <message>
        <source>Tilted [°]</source>
        <translation>Geneigt [°]</translation>
    </message>
    <message>
        <source>Order</source>
        <translation>Reihenfolge</translation>
    </message>
    <message>
        <source>the same</source>
        <translation>gleich</translation>
    </message>
    <message>
        <source>changed</source>
        <translation>geändert</translation>
    </message>
    <message>
        <source>missing in the file</source>
        <translation>fehlt in der Datei</translation>
    </message>
    <message>
        <source>not planned</source>
        <translation>nicht geplant</translation>
    </message>
    <message>
        <source>out of order</source>
        <translation>falsche Reihenfolge</translation>
    </message>
    <message>
        <source>&quot;Compare with file&quot; reads a mission file back and shows what differs.</source>
        <translation>„Mit Datei vergleichen“ liest eine Missionsdatei zurück und zeigt, was abweicht.</translation>
    </message>
    <message>
        <source>{0} is the plan: all {1} photos, in order, along the same path.</source>
        <translation>{0} ist der Plan: alle {1} Fotos, in richtiger Reihenfolge, auf demselben Flugweg.</translation>
    </message>
    <message>
        <source>{0} has all {1} photos of the plan, in order. It holds no path to compare.</source>
        <translation>{0} hat alle {1} Fotos des Plans in richtiger Reihenfolge. Ein Flugweg zum Vergleichen fehlt.</translation>
    </message>
    <message>
        <source>{0} is only a part of the plan, as planned. Sorties without a file: {1}. Choose the files of all sorties together.</source>
        <translation>{0} ist nur ein Teil des Plans, wie geplant. Einsätze ohne Datei: {1}. Die Dateien aller Einsätze zusammen wählen.</translation>
    </message>
    <message>
        <source>{0} takes all {1} photos of the plan, but flies otherwise: {2} out of order</source>
        <translation>{0} macht alle {1} Fotos der Planung, fliegt aber anders: {2} in anderer Reihenfolge</translation>
    </message>
    <message>
        <source>{0} is NOT the plan: {1} photos the same, {2} changed, {3} missing, {4} not planned, {5} out of order</source>
        <translation>{0} ist NICHT der Plan: {1} Fotos gleich, {2} geändert, {3} fehlend, {4} nicht geplant, {5} in falscher Reihenfolge</translation>
    </message>
    <message>
        <source>{0}; the paths are up to {1} apart.</source>
        <translation>{0}; die Flugwege weichen bis zu {1} ab.</translation>
    </message>
</context>
<context>
    <name>ConnectionBox</name>
    <message>
        <source>Simulation</source>
        <translation>Simulation</translation>
    </message>
    <message>
        <source>UDP</source>
        <translation>UDP</translation>
    </message>
    <message>
        <source>TCP</source>
        <translation>TCP</translation>
    </message>
    <message>
        <source>Serial port</source>
        <translation>Serielle Schnittstelle</translation>
    </message>
    <message>
        <source>Vehicle</source>
        <translation>Fluggerät</translation>
    </message>
    <message>
        <source>Autopilot</source>
        <translation>Autopilot</translation>
    </message>
    <message>
        <source>Speed-up</source>
        <translation>Zeitraffer</translation>
    </message>
    <message>
        <source>Address</source>
        <translation>Adresse</translation>
    </message>
    <message>
        <source>Link</source>
        <translation>Verbindung</translation>
    </message>
    <message>
        <source>Disconnect</source>
        <translation>Trennen</translation>
    </message>
    <message>
        <source>Connect</source>
        <translation>Verbinden</translation>
    </message>
</context>
<context>
    <name>Corrections</name>
    <message>
        <source>Move line</source>
        <translation>Linie verschieben</translation>
    </message>
    <message>
        <source>Add line</source>
        <translation>Linie hinzufügen</translation>
    </message>
    <message>
        <source>Delete line</source>
        <translation>Linie löschen</translation>
    </message>
    <message>
        <source>Delete panel</source>
        <translation>Scheibe löschen</translation>
    </message>
    <message>
        <source>Restore panel</source>
        <translation>Scheibe wiederherstellen</translation>
    </message>
</context>
<context>
    <name>CoverageDisplay</name>
    <message>
        <source>{0} photos, {1} of them usable.</source>
        <translation>{0} Fotos, davon {1} brauchbar.</translation>
    </message>
    <message>
        <source>They show {0} of {1} sections.</source>
        <translation>Sie zeigen {0} von {1} Sektoren.</translation>
    </message>
    <message>
        <source>They show {0} sections; the plan promised {1}, of which {2:.1f} % are seen.</source>
        <translation>Sie zeigen {0} Sektoren; der Plan versprach {1}, von denen {2:.1f} % zu sehen sind.</translation>
    </message>
    <message>
        <source>Open or import a site first: photos are placed on it.</source>
        <translation>Öffnen oder importieren Sie zuerst einen Standort: darauf werden die Fotos eingeordnet.</translation>
    </message>
    <message>
        <source>Read the photos of the flight.</source>
        <translation>Lesen Sie die Fotos des Flugs.</translation>
    </message>
    <message>
        <source>The site has no panels yet: find them in these photos.</source>
        <translation>Der Standort hat noch keine Scheiben: suchen Sie sie in diesen Fotos.</translation>
    </message>
    <message>
        <source>The panels or the plan are others now; what the photos show is counted again.</source>
        <translation>Scheiben oder Plan sind jetzt andere; was die Fotos zeigen, wird neu gezählt.</translation>
    </message>
</context>
<context>
    <name>CoverageScene</name>
    <message>
        <source>Seen of what the plan promised</source>
        <translation>Zu sehen von dem, was der Plan versprach</translation>
    </message>
    <message>
        <source>Sections that photos show</source>
        <translation>Sektoren, die Fotos zeigen</translation>
    </message>
</context>
<context>
    <name>DayBox</name>
    <message>
        <source>Planned for</source>
        <translation>Geplant für</translation>
    </message>
    <message>
        <source>Temperature</source>
        <translation>Temperatur</translation>
    </message>
    <message>
        <source>Look where the sun stands, and where glass mirrors it</source>
        <translation>Betrachten, wo die Sonne steht und wo Glas sie spiegelt</translation>
    </message>
    <message>
        <source>Look what cold takes from the batteries</source>
        <translation>Betrachten, was Kälte den Akkus nimmt</translation>
    </message>
    <message>
        <source>Date and time of the flight</source>
        <translation>Datum und Uhrzeit des Flugs</translation>
    </message>
    <message>
        <source>By this computer&apos;s clock and time zone</source>
        <translation>Nach Uhr und Zeitzone dieses Rechners</translation>
    </message>
    <message>
        <source>Temperature at the flight</source>
        <translation>Temperatur beim Flug</translation>
    </message>
</context>
<context>
    <name>EffectsController</name>
    <message>
        <source>Look at the scene</source>
        <translation>Szene auswerten</translation>
    </message>
</context>
<context>
    <name>EffectsPanel</name>
    <message>
        <source>What the scene calls for stands here, once there is a site with panels.</source>
        <translation>Hier steht, was die Szene verlangt, sobald es einen Standort mit Scheiben gibt.</translation>
    </message>
</context>
<context>
    <name>EffectsWindow</name>
    <message>
        <source>Effects of the photo</source>
        <translation>Effekte des Fotos</translation>
    </message>
    <message>
        <source>Effect</source>
        <translation>Effekt</translation>
    </message>
    <message>
        <source>Simulated</source>
        <translation>Simuliert</translation>
    </message>
    <message>
        <source>on</source>
        <translation>an</translation>
    </message>
    <message>
        <source>off</source>
        <translation>aus</translation>
    </message>
    <message>
        <source>Size</source>
        <translation>Größe</translation>
    </message>
    <message>
        <source>Off below</source>
        <translation>Aus unter</translation>
    </message>
    <message>
        <source>Why</source>
        <translation>Warum</translation>
    </message>
    <message>
        <source>An effect is simulated where the picture would change by more than its limit without it: here a picture of {0} x {1} pixels. Not in previews, because it takes long: {2}.</source>
        <translation>Ein Effekt wird simuliert, wo sich das Bild ohne ihn um mehr als seine Grenze ändern würde: hier ein Bild von {0} x {1} Pixeln. Nicht in der Vorschau, weil es lange dauert: {2}.</translation>
    </message>
    <message>
        <source>{0:.3g} {1}</source>
        <translation>{0:.3g} {1}</translation>
    </message>
    <message>
        <source>No photo is shown.</source>
        <translation>Es wird kein Foto gezeigt.</translation>
    </message>
    <message>
        <source>The coarse picture has all effects of light; the scene is asked for the fine one.</source>
        <translation>Das grobe Bild hat alle Effekte des Lichts; für das feine wird die Szene befragt.</translation>
    </message>
</context>
<context>
    <name>ErrorStrip</name>
    <message>
        <source>Photos of the data set, and how well the model shows them</source>
        <translation>Fotos des Datensatzes, und wie gut das Modell sie zeigt</translation>
    </message>
    <message>
        <source>{0:.2f} dB on the facades, as the model is now</source>
        <translation>{0:.2f} dB auf den Fassaden, wie das Modell jetzt ist</translation>
    </message>
    <message>
        <source>{0} not learned from: kept for scoring</source>
        <translation>{0} nicht gelernt: zum Bewerten aufgehoben</translation>
    </message>
</context>
<context>
    <name>ExportDialog</name>
    <message>
        <source>Export mission files</source>
        <translation>Missionsdateien exportieren</translation>
    </message>
    <message>
        <source>Write ...</source>
        <translation>Schreiben ...</translation>
    </message>
    <message>
        <source>Export</source>
        <translation>Exportieren</translation>
    </message>
    <message>
        <source>Making the files ...</source>
        <translation>Dateien werden erstellt ...</translation>
    </message>
    <message>
        <source>Prepare export</source>
        <translation>Export vorbereiten</translation>
    </message>
    <message>
        <source>No objections to these files.</source>
        <translation>Keine Einwände gegen diese Dateien.</translation>
    </message>
    <message>
        <source>Cannot be exported: {0}</source>
        <translation>Export nicht möglich: {0}</translation>
    </message>
    <message>
        <source>Not to be written like this: see the errors.</source>
        <translation>So nicht zu schreiben: siehe die Fehler.</translation>
    </message>
    <message>
        <source>Ready to be written, files: {0}. Read the warnings.</source>
        <translation>Bereit zum Schreiben, Dateien: {0}. Warnungen lesen.</translation>
    </message>
    <message>
        <source>Ready to be written, files: {0}</source>
        <translation>Bereit zum Schreiben, Dateien: {0}</translation>
    </message>
    <message>
        <source>Write mission files</source>
        <translation>Missionsdateien schreiben</translation>
    </message>
    <message>
        <source>Mission files (*{0})</source>
        <translation>Missionsdateien (*{0})</translation>
    </message>
    <message>
        <source>Replace files?</source>
        <translation>Dateien ersetzen?</translation>
    </message>
    <message>
        <source>These files are replaced: {0}</source>
        <translation>Diese Dateien werden ersetzt: {0}</translation>
    </message>
    <message>
        <source>Written: {0}</source>
        <translation>Geschrieben: {0}</translation>
    </message>
    <message>
        <source>Not written: {0}</source>
        <translation>Nicht geschrieben: {0}</translation>
    </message>
    <message>
        <source>Export the model</source>
        <translation>Modell exportieren</translation>
    </message>
    <message>
        <source>the whole model</source>
        <translation>das ganze Modell</translation>
    </message>
    <message>
        <source>Format</source>
        <translation>Format</translation>
    </message>
    <message>
        <source>Part</source>
        <translation>Teil</translation>
    </message>
    <message>
        <source>Choose a place ...</source>
        <translation>Ort wählen ...</translation>
    </message>
</context>
<context>
    <name>ExportForm</name>
    <message>
        <source>above everything on the site</source>
        <translation>über allem am Standort</translation>
    </message>
    <message>
        <source>Format</source>
        <translation>Format</translation>
    </message>
    <message>
        <source>Above take-off</source>
        <translation>Über Start</translation>
    </message>
</context>
<context>
    <name>ExtentBox</name>
    <message>
        <source>from</source>
        <translation>von</translation>
    </message>
    <message>
        <source>to</source>
        <translation>bis</translation>
    </message>
</context>
<context>
    <name>FacadePage</name>
    <message>
        <source>Facade</source>
        <translation>Fassade</translation>
    </message>
    <message>
        <source>Turn to the other side</source>
        <translation>Seite umdrehen</translation>
    </message>
    <message>
        <source>No panels</source>
        <translation>Keine Scheiben</translation>
    </message>
    <message>
        <source>Panels: {0}, {1} of glass
Faces: {2}</source>
        <translation>Scheiben: {0}, {1} Glas
Blickrichtung: {2}</translation>
    </message>
    <message>
        <source>up</source>
        <translation>nach oben</translation>
    </message>
    <message>
        <source>down</source>
        <translation>nach unten</translation>
    </message>
    <message>
        <source>Turn facade {0}</source>
        <translation>Fassade {0} drehen</translation>
    </message>
</context>
<context>
    <name>FacadeTable</name>
    <message>
        <source>Facades found</source>
        <translation>Gefundene Fassaden</translation>
    </message>
    <message>
        <source>Facade</source>
        <translation>Fassade</translation>
    </message>
    <message>
        <source>Panels</source>
        <translation>Scheiben</translation>
    </message>
    <message>
        <source>Photos</source>
        <translation>Fotos</translation>
    </message>
</context>
<context>
    <name>FilesBox</name>
    <message>
        <source>Choose...</source>
        <translation>Wählen...</translation>
    </message>
    <message>
        <source>None</source>
        <translation>Keine</translation>
    </message>
    <message>
        <source>no file</source>
        <translation>keine Datei</translation>
    </message>
    <message>
        <source>Heights ({0});;All files (*)</source>
        <translation>Höhen ({0});;Alle Dateien (*)</translation>
    </message>
</context>
<context>
    <name>FindingsList</name>
    <message>
        <source>Findings</source>
        <translation>Befunde</translation>
    </message>
    <message>
        <source>All checks passed: home, airspace, facades.</source>
        <translation>Alle Prüfungen bestanden: Startplatz, Luftraum, Fassaden.</translation>
    </message>
    <message>
        <source>Error</source>
        <translation>Fehler</translation>
    </message>
    <message>
        <source>Warning</source>
        <translation>Warnung</translation>
    </message>
    <message>
        <source>Note</source>
        <translation>Hinweis</translation>
    </message>
    <message>
        <source>Kept</source>
        <translation>Eingehalten</translation>
    </message>
    <message>
        <source>Click to see the place</source>
        <translation>Klicken zeigt den Ort</translation>
    </message>
    <message>
        <source>{0} ({1})</source>
        <translation>{0} ({1})</translation>
    </message>
    <message>
        <source>measured {0}</source>
        <translation>gemessen {0}</translation>
    </message>
    <message>
        <source>limit {0}</source>
        <translation>Grenze {0}</translation>
    </message>
    <message>
        <source>at {0}</source>
        <translation>bei {0}</translation>
    </message>
    <message>
        <source>The site is being checked ...</source>
        <translation>Der Standort wird geprüft ...</translation>
    </message>
    <message>
        <source>The site&apos;s check found: {0}</source>
        <translation>Befunde der Standortprüfung: {0}</translation>
    </message>
</context>
<context>
    <name>FindingsView</name>
    <message>
        <source>Check</source>
        <translation>Prüfen</translation>
    </message>
    <message>
        <source>Measure every pre-flight rule again</source>
        <translation>Jede Regel vor dem Flug neu messen</translation>
    </message>
    <message>
        <source>Not checked yet.</source>
        <translation>Noch nicht geprüft.</translation>
    </message>
    <message>
        <source>All checks passed. The button with the tick lists them.</source>
        <translation>Alle Prüfungen bestanden. Der Knopf mit dem Haken zeigt sie.</translation>
    </message>
    <message>
        <source>Older than the plan: it was changed after this check.</source>
        <translation>Älter als der Plan: Er wurde nach dieser Prüfung geändert.</translation>
    </message>
    <message>
        <source>Checking ...</source>
        <translation>Wird geprüft ...</translation>
    </message>
    <message>
        <source>Readiness not known</source>
        <translation>Flugbereitschaft unbekannt</translation>
    </message>
    <message>
        <source>Ready to fly</source>
        <translation>Flugbereit</translation>
    </message>
    <message>
        <source>Ready to fly, but read the warnings</source>
        <translation>Bereit zum Flug, aber die Warnungen lesen</translation>
    </message>
    <message>
        <source>NOT ready to fly</source>
        <translation>NICHT flugbereit</translation>
    </message>
</context>
<context>
    <name>FlightButtons</name>
    <message>
        <source>Hold: {0}</source>
        <translation>Halten: {0}</translation>
    </message>
    <message>
        <source>{0} ({1})</source>
        <translation>{0} ({1})</translation>
    </message>
    <message>
        <source>Upload</source>
        <translation>Hochladen</translation>
    </message>
    <message>
        <source>Send the mission, and read it back</source>
        <translation>Die Mission senden und zurücklesen</translation>
    </message>
    <message>
        <source>Start</source>
        <translation>Start</translation>
    </message>
    <message>
        <source>Take off and fly the mission; asks first</source>
        <translation>Abheben und die Mission fliegen; fragt vorher</translation>
    </message>
    <message>
        <source>Pause</source>
        <translation>Pause</translation>
    </message>
    <message>
        <source>Stop on the spot and hover</source>
        <translation>Auf der Stelle anhalten und schweben</translation>
    </message>
    <message>
        <source>Resume</source>
        <translation>Fortsetzen</translation>
    </message>
    <message>
        <source>Go on with the mission</source>
        <translation>Mit der Mission weitermachen</translation>
    </message>
    <message>
        <source>Fly home and land there</source>
        <translation>Zum Startplatz fliegen und dort landen</translation>
    </message>
    <message>
        <source>Return to home (RTH)</source>
        <translation>Rückkehr (RTH)</translation>
    </message>
    <message>
        <source>Land</source>
        <translation>Landen</translation>
    </message>
    <message>
        <source>Land here and now</source>
        <translation>Hier und jetzt landen</translation>
    </message>
</context>
<context>
    <name>FlightFigures</name>
    <message>
        <source>Flight figures</source>
        <translation>Flugwerte</translation>
    </message>
    <message>
        <source>min {0}</source>
        <translation>min. {0}</translation>
    </message>
    <message>
        <source>reserve in {0}</source>
        <translation>Reserve in {0}</translation>
    </message>
    <message>
        <source>above ground</source>
        <translation>über Grund</translation>
    </message>
    <message>
        <source>to the facade</source>
        <translation>zur Fassade</translation>
    </message>
    <message>
        <source>speed</source>
        <translation>Tempo</translation>
    </message>
    <message>
        <source>battery</source>
        <translation>Akku</translation>
    </message>
    <message>
        <source>to go</source>
        <translation>noch</translation>
    </message>
    <message>
        <source>wind</source>
        <translation>Wind</translation>
    </message>
    <message>
        <source>in {0}</source>
        <translation>in {0}</translation>
    </message>
    <message>
        <source>{0} missing</source>
        <translation>{0} fehlen</translation>
    </message>
    <message>
        <source>next photo</source>
        <translation>nächstes Foto</translation>
    </message>
    <message>
        <source>all photos</source>
        <translation>alle Fotos</translation>
    </message>
</context>
<context>
    <name>FlightNotes</name>
    <message>
        <source>What happened in the flight</source>
        <translation>Was im Flug geschah</translation>
    </message>
    <message>
        <source>Minutes and seconds after take-off, as in the plan and the report</source>
        <translation>Minuten und Sekunden nach dem Start, wie im Plan und im Bericht</translation>
    </message>
</context>
<context>
    <name>FlightQuestions</name>
    <message>
        <source>Start the flight</source>
        <translation>Den Flug starten</translation>
    </message>
    <message>
        <source>The motors will start. The aircraft climbs up to {0} above take-off, flies {1} in about {2}, </source>
        <translation>Die Motoren laufen an. Das Fluggerät steigt bis {0} über den Startplatz, fliegt {1} in etwa {2}, </translation>
    </message>
    <message>
        <source>takes {0} photos, comes no closer than {1} to anything, returns and lands.</source>
        <translation>macht {0} Fotos, kommt nichts näher als {1}, kehrt zurück und landet.</translation>
    </message>
    <message>
        <source>It uses about {0:.0%} of a full battery.</source>
        <translation>Es braucht etwa {0:.0%} eines vollen Akkus.</translation>
    </message>
    <message>
        <source>Is everybody clear of the aircraft?</source>
        <translation>Halten alle Abstand vom Fluggerät?</translation>
    </message>
    <message>
        <source>{0} is slower than the plan, which reckons with {1}.</source>
        <translation>{0} ist langsamer als der Plan, der mit {1} rechnet.</translation>
    </message>
    <message>
        <source>Away from home it flies {0} above the ground or higher.</source>
        <translation>Abseits des Startplatzes fliegt es {0} oder höher über dem Boden.</translation>
    </message>
    <message>
        <source>Away from home it flies down to {0} above the ground, {1} of it below {2}: nobody may be there.</source>
        <translation>Abseits des Startplatzes fliegt es bis zu {0} über dem Boden herunter, davon {1} unter {2}: dort darf niemand sein.</translation>
    </message>
    <message>
        <source>Too many photos for one sortie</source>
        <translation>Zu viele Fotos für einen Einsatz</translation>
    </message>
    <message>
        <source>{0} keeps the items of about {1} photos, and a sortie of this plan has {2}: the vehicle would refuse it. Share the same views out among more sorties, as a plan of its own, and connect for that?</source>
        <translation>{0} fasst die Einträge von etwa {1} Fotos, und ein Einsatz dieses Plans hat {2}: Das Fluggerät würde ihn ablehnen. Dieselben Aufnahmen als eigenen Plan auf mehr Einsätze verteilen und dafür verbinden?</translation>
    </message>
    <message>
        <source>Set parameters of the vehicle</source>
        <translation>Parameter des Fluggeräts setzen</translation>
    </message>
    <message>
        <source>These parameters of the vehicle are set, and they stay so:</source>
        <translation>Diese Parameter des Fluggeräts werden gesetzt und bleiben so:</translation>
    </message>
    <message>
        <source>These are set, and the autopilot is restarted after it:</source>
        <translation>Diese werden gesetzt, und danach wird der Autopilot neu gestartet:</translation>
    </message>
    <message>
        <source>Set them?</source>
        <translation>Setzen?</translation>
    </message>
    <message>
        <source>The aircraft stands {0} {1} than planned. Its heights above take-off are made as much {2}, so that it flies through the same places, and have to be uploaded again. Do so only where you know that it really stands there: a GNSS height can be wrong by metres. Fly from this height?</source>
        <translation>Das Fluggerät steht {0} {1} als geplant. Seine Höhen über dem Startplatz werden um ebenso viel {2}, damit es durch dieselben Stellen fliegt, und müssen noch einmal hochgeladen werden. Nur tun, wenn sicher ist, dass es wirklich dort steht: Eine GNSS-Höhe kann um Meter falsch sein. Von dieser Höhe fliegen?</translation>
    </message>
    <message>
        <source>lower</source>
        <translation>niedriger</translation>
    </message>
    <message>
        <source>larger</source>
        <translation>größer</translation>
    </message>
    <message>
        <source>higher</source>
        <translation>höher</translation>
    </message>
    <message>
        <source>smaller</source>
        <translation>kleiner</translation>
    </message>
    <message>
        <source>Fly from this height</source>
        <translation>Von dieser Höhe fliegen</translation>
    </message>
    <message>
        <source>The site&apos;s home moves to where the aircraft stands (Undo takes it back). Plans start at home, so the flight has to be planned again. Move it?</source>
        <translation>Der Startplatz des Standorts rückt dorthin, wo das Fluggerät steht (Rückgängig nimmt es zurück). Pläne beginnen am Startplatz, also muss der Flug neu geplant werden. Verschieben?</translation>
    </message>
    <message>
        <source>Home here</source>
        <translation>Startplatz hier</translation>
    </message>
    <message>
        <source>{0}

To fly all the same, type {1}:</source>
        <translation>{0}

Um trotzdem zu fliegen, {1} eintippen:</translation>
    </message>
    <message>
        <source>Overrule</source>
        <translation>Übergehen</translation>
    </message>
    <message>
        <source>{0} of {1} sections are missing. Showing {2} of them takes {3} in the air (photos: {4}, batteries: {5}). Plan this flight?</source>
        <translation>Es fehlen {0} von {1} Sektoren. {2} davon zu zeigen dauert {3} in der Luft (Fotos: {4}, Akkus: {5}). Diesen Flug planen?</translation>
    </message>
    <message>
        <source>Hardly anything is missing</source>
        <translation>Es fehlt kaum etwas</translation>
    </message>
    <message>
        <source>The aircraft is in the air</source>
        <translation>Das Fluggerät ist in der Luft</translation>
    </message>
    <message>
        <source>It goes on with what it does now, without this window: nothing will warn you, and you fly it by the remote control. What was recorded so far is kept. Leave it?</source>
        <translation>Es macht mit dem weiter, was es gerade tut, ohne dieses Fenster: Nichts warnt Sie, und Sie fliegen mit der Fernsteuerung. Was bisher aufgezeichnet wurde, bleibt. Verlassen?</translation>
    </message>
</context>
<context>
    <name>FlightTexts</name>
    <message>
        <source>{0}, signed</source>
        <translation>{0}, signiert</translation>
    </message>
    <message>
        <source>Simulation, {0:g} times as fast</source>
        <translation>Simulation, {0:g}-mal so schnell</translation>
    </message>
    <message>
        <source>Open or import a site first, on the Site tab.</source>
        <translation>Zuerst auf der Seite „Standort“ einen Standort öffnen oder importieren.</translation>
    </message>
    <message>
        <source>Plan a flight first, on the Plan tab.</source>
        <translation>Zuerst auf der Seite „Planung“ einen Flug planen.</translation>
    </message>
    <message>
        <source>The flight is being prepared ...</source>
        <translation>Der Flug wird vorbereitet ...</translation>
    </message>
    <message>
        <source>Not connected.</source>
        <translation>Nicht verbunden.</translation>
    </message>
    <message>
        <source>The link is being opened ...</source>
        <translation>Die Verbindung wird geöffnet ...</translation>
    </message>
    <message>
        <source>The link is open; no vehicle was heard yet.</source>
        <translation>Die Verbindung ist offen; noch kein Fluggerät gehört.</translation>
    </message>
    <message>
        <source>Connected. Upload the mission.</source>
        <translation>Verbunden. Die Mission hochladen.</translation>
    </message>
    <message>
        <source>Connecting ...</source>
        <translation>Verbindung wird aufgebaut ...</translation>
    </message>
    <message>
        <source>The vehicle is being prepared ...</source>
        <translation>Das Fluggerät wird vorbereitet ...</translation>
    </message>
    <message>
        <source>Uploading ...</source>
        <translation>Hochladen ...</translation>
    </message>
    <message>
        <source>On board. Waiting for the list.</source>
        <translation>An Bord. Warten auf die Liste.</translation>
    </message>
    <message>
        <source>Ready for take-off.</source>
        <translation>Startbereit.</translation>
    </message>
    <message>
        <source>Starting ...</source>
        <translation>Start läuft ...</translation>
    </message>
    <message>
        <source>Flying.</source>
        <translation>Im Flug.</translation>
    </message>
    <message>
        <source>Landed.</source>
        <translation>Gelandet.</translation>
    </message>
    <message>
        <source>This connection is for another plan. Disconnect, and connect for the plan that is shown.</source>
        <translation>Diese Verbindung ist für einen anderen Plan. Trennen und für den gezeigten Plan verbinden.</translation>
    </message>
    <message>
        <source>{0} ({1:.1f} of {2:.1f} MB)</source>
        <translation>{0} ({1:.1f} von {2:.1f} MB)</translation>
    </message>
    <message>
        <source>{0} {1} ({2:.0f} of {3:.0f})</source>
        <translation>{0} {1} ({2:.0f} von {3:.0f})</translation>
    </message>
    <message>
        <source>{0} Mode: {1}</source>
        <translation>{0} Modus: {1}</translation>
    </message>
</context>
<context>
    <name>FlyController</name>
    <message>
        <source>Home to the aircraft</source>
        <translation>Startplatz zum Fluggerät</translation>
    </message>
    <message>
        <source>Home is where the aircraft stands: plan again, then connect anew.</source>
        <translation>Der Startplatz ist jetzt, wo das Fluggerät steht: neu planen, dann neu verbinden.</translation>
    </message>
    <message>
        <source>Prepare the flight</source>
        <translation>Flug vorbereiten</translation>
    </message>
    <message>
        <source>connecting</source>
        <translation>Verbindung wird aufgebaut</translation>
    </message>
    <message>
        <source>simulated battery: {0:.0%}, as the flight before left it</source>
        <translation>simulierter Akku: {0:.0%}, wie ihn der Flug davor hinterließ</translation>
    </message>
    <message>
        <source>autopilot: {0}</source>
        <translation>Autopilot: {0}</translation>
    </message>
    <message>
        <source>link lost</source>
        <translation>Verbindung verloren</translation>
    </message>
    <message>
        <source>link lost: {0}</source>
        <translation>Verbindung verloren: {0}</translation>
    </message>
    <message>
        <source>link alive</source>
        <translation>Verbindung steht</translation>
    </message>
    <message>
        <source>link found again</source>
        <translation>Verbindung wieder da</translation>
    </message>
    <message>
        <source>disconnected</source>
        <translation>getrennt</translation>
    </message>
    <message>
        <source>landed</source>
        <translation>gelandet</translation>
    </message>
    <message>
        <source>proved by its checksum</source>
        <translation>durch seine Prüfsumme bewiesen</translation>
    </message>
    <message>
        <source>not proved: it knows no checksums</source>
        <translation>nicht bewiesen: es kennt keine Prüfsummen</translation>
    </message>
    <message>
        <source>vehicle&apos;s log: {0}, {1}</source>
        <translation>Log des Fahrzeugs: {0}, {1}</translation>
    </message>
    <message>
        <source>The report is made from the vehicle&apos;s own log.</source>
        <translation>Der Bericht ist aus dem eigenen Log des Fahrzeugs.</translation>
    </message>
    <message>
        <source>Report</source>
        <translation>Bericht</translation>
    </message>
</context>
<context>
    <name>FlyPage</name>
    <message>
        <source>Lists</source>
        <translation>Listen</translation>
    </message>
    <message>
        <source>Show what stands beside and below the view, which has their room in flight</source>
        <translation>Zeigt, was neben und unter der Ansicht steht; im Flug hat sie diesen Platz</translation>
    </message>
    <message>
        <source>Log book ...</source>
        <translation>Logbuch ...</translation>
    </message>
    <message>
        <source>Flights with aircraft, battery, times and findings; cycles of batteries</source>
        <translation>Flüge mit Luftfahrzeug, Akku, Zeiten und Befunden; Zyklen der Akkus</translation>
    </message>
    <message>
        <source>Lists beside the view</source>
        <translation>Listen neben der Ansicht</translation>
    </message>
    <message>
        <source>Camera picture large</source>
        <translation>Kamerabild groß</translation>
    </message>
    <message>
        <source>Mute warnings</source>
        <translation>Warnungen stumm</translation>
    </message>
    <message>
        <source>Sortie to be flown</source>
        <translation>Zu fliegender Einsatz</translation>
    </message>
    <message>
        <source>Flight</source>
        <translation>Flug</translation>
    </message>
    <message>
        <source>Simulation</source>
        <translation>Simulation</translation>
    </message>
    <message>
        <source>Settings</source>
        <translation>Einstellungen</translation>
    </message>
    <message>
        <source>Photos</source>
        <translation>Fotos</translation>
    </message>
    <message>
        <source>Report</source>
        <translation>Bericht</translation>
    </message>
    <message>
        <source>Findings</source>
        <translation>Befunde</translation>
    </message>
    <message>
        <source>After the landing, what the report found stands here.</source>
        <translation>Nach der Landung steht hier, was der Bericht befunden hat.</translation>
    </message>
    <message>
        <source>Sortie {0}: photos: {1}, {2}</source>
        <translation>Einsatz {0}: Fotos: {1}, {2}</translation>
    </message>
    <message>
        <source>; aircraft {0} starts at {1}</source>
        <translation>; Fluggerät {0} startet bei {1}</translation>
    </message>
    <message>
        <source>Findings ({0})</source>
        <translation>Befunde ({0})</translation>
    </message>
    <message>
        <source>In flight; the list comes back after the landing.</source>
        <translation>Im Flug; die Liste kommt nach der Landung wieder.</translation>
    </message>
</context>
<context>
    <name>FolderController</name>
    <message>
        <source>Read the data set</source>
        <translation>Datensatz lesen</translation>
    </message>
    <message>
        <source>This data set shows other panels than the site that is open ({0} against {1}). It can be trained on all the same; is it the right one?</source>
        <translation>Dieser Datensatz zeigt andere Scheiben als der geöffnete Standort ({0} gegen {1}). Trainiert werden kann trotzdem; ist es der richtige?</translation>
    </message>
    <message>
        <source>Look for models</source>
        <translation>Modelle suchen</translation>
    </message>
</context>
<context>
    <name>GridController</name>
    <message>
        <source>Checking ...</source>
        <translation>Wird geprüft ...</translation>
    </message>
    <message>
        <source>Check the panel grid</source>
        <translation>Scheibenraster prüfen</translation>
    </message>
    <message>
        <source>The panels lie on the building and look outwards.</source>
        <translation>Die Scheiben liegen am Gebäude und zeigen nach außen.</translation>
    </message>
    <message>
        <source>Add panel grid {0}</source>
        <translation>Scheibenraster {0} hinzufügen</translation>
    </message>
</context>
<context>
    <name>GridForm</name>
    <message>
        <source>How far the panels may lie from the building&apos;s mesh</source>
        <translation>Wie weit die Scheiben neben dem Gebäudenetz liegen dürfen</translation>
    </message>
    <message>
        <source>Pick the rectangle on the wall</source>
        <translation>Rechteck an der Wand wählen</translation>
    </message>
    <message>
        <source>Add these panels</source>
        <translation>Diese Scheiben hinzufügen</translation>
    </message>
    <message>
        <source>Cancel</source>
        <translation>Abbrechen</translation>
    </message>
    <message>
        <source>Rows</source>
        <translation>Zeilen</translation>
    </message>
    <message>
        <source>Columns</source>
        <translation>Spalten</translation>
    </message>
    <message>
        <source>Gap</source>
        <translation>Fuge</translation>
    </message>
    <message>
        <source>Off the wall by up to</source>
        <translation>Abweichung von der Wand bis</translation>
    </message>
    <message>
        <source>Lower left</source>
        <translation>Unten links</translation>
    </message>
    <message>
        <source>Lower right</source>
        <translation>Unten rechts</translation>
    </message>
    <message>
        <source>Upper left</source>
        <translation>Oben links</translation>
    </message>
    <message>
        <source>Rows and columns</source>
        <translation>Zeilen und Spalten</translation>
    </message>
    <message>
        <source>Rectangle</source>
        <translation>Rechteck</translation>
    </message>
    <message>
        <source>Three clicks: lower left, lower right, upper edge, as seen from outside.</source>
        <translation>Drei Klicks: unten links, unten rechts, Oberkante, von außen gesehen.</translation>
    </message>
    <message>
        <source>Wall: {0} × {1}
Panels: {2}, each {3} × {4}</source>
        <translation>Wand: {0} × {1}
Scheiben: {2}, je {3} × {4}</translation>
    </message>
</context>
<context>
    <name>GridPicture</name>
    <message>
        <source>panel, sure</source>
        <translation>Scheibe, sicher</translation>
    </message>
    <message>
        <source>panel, less sure</source>
        <translation>Scheibe, weniger sicher</translation>
    </message>
    <message>
        <source>panel, doubtful</source>
        <translation>Scheibe, zweifelhaft</translation>
    </message>
    <message>
        <source>no panel</source>
        <translation>keine Scheibe</translation>
    </message>
    <message>
        <source>not seen, follows from the spacing</source>
        <translation>nicht gesehen, folgt aus den Abständen</translation>
    </message>
    <message>
        <source>known panel, not looked for here</source>
        <translation>bekannte Scheibe, hier nicht gesucht</translation>
    </message>
</context>
<context>
    <name>GridView</name>
    <message>
        <source>Photo with the grid found in it</source>
        <translation>Foto mit dem Raster, das darin gefunden wurde</translation>
    </message>
    <message>
        <source>Tab chooses a line, arrows move it, Shift by ten pixels; Delete removes it, Insert adds one.</source>
        <translation>Tab wählt eine Linie, Pfeile verschieben sie, mit Umschalt um zehn Pixel; Entf entfernt sie, Einfg fügt eine hinzu.</translation>
    </message>
    <message>
        <source>row {0}, column {1}</source>
        <translation>Reihe {0}, Spalte {1}</translation>
    </message>
    <message>
        <source>{0}: no panel</source>
        <translation>{0}: keine Scheibe</translation>
    </message>
    <message>
        <source>{0}: confidence {1:.0f} %</source>
        <translation>{0}: Sicherheit {1:.0f} %</translation>
    </message>
</context>
<context>
    <name>GroundRiskForm</name>
    <message>
        <source>More settings</source>
        <translation>Weitere Einstellungen</translation>
    </message>
</context>
<context>
    <name>HemisphereView</name>
    <message>
        <source>Click a panel to see from where it is photographed.</source>
        <translation>Eine Scheibe anklicken, um zu sehen, von wo sie fotografiert wird.</translation>
    </message>
</context>
<context>
    <name>HomePage</name>
    <message>
        <source>Put it on the ground</source>
        <translation>Auf den Boden setzen</translation>
    </message>
    <message>
        <source>Home</source>
        <translation>Startplatz</translation>
    </message>
    <message>
        <source>Move home</source>
        <translation>Startplatz versetzen</translation>
    </message>
    <message>
        <source>Put home on the ground</source>
        <translation>Startplatz auf den Boden setzen</translation>
    </message>
</context>
<context>
    <name>ImportDialog</name>
    <message>
        <source>Import {0}</source>
        <translation>{0} importieren</translation>
    </message>
    <message>
        <source>Use these panels</source>
        <translation>Diese Scheiben übernehmen</translation>
    </message>
    <message>
        <source>Clear</source>
        <translation>Verwerfen</translation>
    </message>
    <message>
        <source>Preview again</source>
        <translation>Neue Vorschau</translation>
    </message>
    <message>
        <source>Import</source>
        <translation>Importieren</translation>
    </message>
    <message>
        <source>Cancel</source>
        <translation>Abbrechen</translation>
    </message>
    <message>
        <source>Facade grid</source>
        <translation>Fassadenraster</translation>
    </message>
    <message>
        <source>Reading {0} ...</source>
        <translation>{0} wird gelesen ...</translation>
    </message>
    <message>
        <source>Preview {0}</source>
        <translation>Vorschau {0}</translation>
    </message>
    <message>
        <source>Reading failed; the reason stands below.</source>
        <translation>Das Lesen ist gescheitert; der Grund steht unten.</translation>
    </message>
    <message>
        <source>Reading {0}: {1} ...</source>
        <translation>{0} wird gelesen: {1} ...</translation>
    </message>
    <message>
        <source>The options were changed: press “Preview again”.</source>
        <translation>Die Optionen wurden geändert: „Neue Vorschau“ drücken.</translation>
    </message>
    <message>
        <source>Checking ...</source>
        <translation>Wird geprüft ...</translation>
    </message>
    <message>
        <source>The panels lie on the building and look outwards.</source>
        <translation>Die Scheiben liegen am Gebäude und zeigen nach außen.</translation>
    </message>
    <message>
        <source>Check the panel grid</source>
        <translation>Scheibenraster prüfen</translation>
    </message>
</context>
<context>
    <name>ImportForm</name>
    <message>
        <source>As the file suggests</source>
        <translation>Wie die Datei nahelegt</translation>
    </message>
    <message>
        <source>as the file says</source>
        <translation>laut Datei</translation>
    </message>
    <message>
        <source>As usual for the format</source>
        <translation>Wie im Format üblich</translation>
    </message>
    <message>
        <source>Zero point on earth</source>
        <translation>Nullpunkt auf der Erde</translation>
    </message>
    <message>
        <source>Coordinate system</source>
        <translation>Koordinatensystem</translation>
    </message>
    <message>
        <source>As the file says</source>
        <translation>Laut Datei</translation>
    </message>
    <message>
        <source>Found out</source>
        <translation>Automatisch</translation>
    </message>
    <message>
        <source>East first</source>
        <translation>Ost zuerst</translation>
    </message>
    <message>
        <source>North first</source>
        <translation>Nord zuerst</translation>
    </message>
    <message>
        <source>As the system says</source>
        <translation>Laut System</translation>
    </message>
    <message>
        <source>Above sea level</source>
        <translation>Über Meer</translation>
    </message>
    <message>
        <source>Above the ellipsoid</source>
        <translation>Über Ellipsoid</translation>
    </message>
    <message>
        <source>found around the building</source>
        <translation>am Gebäude ermittelt</translation>
    </message>
    <message>
        <source>Building</source>
        <translation>Gebäude</translation>
    </message>
    <message>
        <source>Facade grid</source>
        <translation>Fassadenraster</translation>
    </message>
    <message>
        <source>Unit of lengths</source>
        <translation>Längeneinheit</translation>
    </message>
    <message>
        <source>Axis that points up</source>
        <translation>Achse nach oben</translation>
    </message>
    <message>
        <source>Place on earth</source>
        <translation>Lage auf der Erde</translation>
    </message>
    <message>
        <source>Code of the system</source>
        <translation>Code des Systems</translation>
    </message>
    <message>
        <source>Order of coordinates</source>
        <translation>Koordinatenfolge</translation>
    </message>
    <message>
        <source>Heights are</source>
        <translation>Höhen sind</translation>
    </message>
    <message>
        <source>Height of the ground in the file</source>
        <translation>Höhe des Bodens in der Datei</translation>
    </message>
    <message>
        <source>Airspace around the building</source>
        <translation>Luftraum um das Gebäude</translation>
    </message>
    <message>
        <source>Name of the site</source>
        <translation>Name des Standorts</translation>
    </message>
    <message>
        <source>Airspace up to, in the Site tab</source>
        <translation>Luftraum bis, im Reiter Standort</translation>
    </message>
    <message>
        <source>Airspace up from, in the Site tab</source>
        <translation>Luftraum von, im Reiter Standort</translation>
    </message>
    <message>
        <source>Gap</source>
        <translation>Fuge</translation>
    </message>
    <message>
        <source>Off the wall by up to</source>
        <translation>Abweichung von der Wand bis</translation>
    </message>
    <message>
        <source>Home, in the Site tab</source>
        <translation>Startplatz, im Reiter Standort</translation>
    </message>
    <message>
        <source>Columns</source>
        <translation>Spalten</translation>
    </message>
    <message>
        <source>Rows</source>
        <translation>Zeilen</translation>
    </message>
    <message>
        <source>{0}: windows {1}, {2}</source>
        <translation>{0}: Fenster {1}, {2}</translation>
    </message>
</context>
<context>
    <name>ImportTexts</name>
    <message>
        <source>Size {0} (east × north × up); triangles: {1}</source>
        <translation>Größe {0} (Ost × Nord × Höhe); Dreiecke: {1}</translation>
    </message>
    <message>
        <source>Zero at {0:.6f}°, {1:.6f}°, {2} above the ellipsoid, {3} above sea level (EGM96)</source>
        <translation>Nullpunkt bei {0:.6f}°, {1:.6f}°, {2} über Ellipsoid, {3} über Meer (EGM96)</translation>
    </message>
    <message>
        <source>No panels yet: find them in photos after the import, or pick a panel grid here.</source>
        <translation>Noch keine Scheiben: nach dem Import in Fotos suchen oder hier ein Scheibenraster wählen.</translation>
    </message>
    <message>
        <source>{0} smaller ones</source>
        <translation>{0} kleinere</translation>
    </message>
    <message>
        <source>Panels: {0}, {1} of glass; by facade: {2}</source>
        <translation>Scheiben: {0}, {1} Glas; nach Fassade: {2}</translation>
    </message>
</context>
<context>
    <name>ItemLimit</name>
    <message>
        <source>{0}, shared out</source>
        <translation>{0}, neu verteilt</translation>
    </message>
    <message>
        <source>Share views out</source>
        <translation>Aufnahmen verteilen</translation>
    </message>
    <message>
        <source>Views shared out anew, sorties: {0}</source>
        <translation>Aufnahmen neu verteilt, Einsätze: {0}</translation>
    </message>
</context>
<context>
    <name>ItemPage</name>
    <message>
        <source>Delete</source>
        <translation>Löschen</translation>
    </message>
    <message>
        <source>Rename {0}</source>
        <translation>{0} umbenennen</translation>
    </message>
    <message>
        <source>Delete {0}</source>
        <translation>{0} löschen</translation>
    </message>
</context>
<context>
    <name>JobBar</name>
    <message>
        <source>Cancel</source>
        <translation>Abbrechen</translation>
    </message>
    <message>
        <source>Throw the running job away</source>
        <translation>Laufende Aufgabe verwerfen</translation>
    </message>
    <message>
        <source>{0}: cancelling ...</source>
        <translation>{0}: wird abgebrochen ...</translation>
    </message>
    <message>
        <source>{0} waiting</source>
        <translation>{0} wartend</translation>
    </message>
    <message>
        <source>{0} left</source>
        <translation>noch {0}</translation>
    </message>
    <message>
        <source>{0} so far</source>
        <translation>bisher {0}</translation>
    </message>
    <message>
        <source>this step: {0} left</source>
        <translation>dieser Schritt: noch {0}</translation>
    </message>
    <message>
        <source>Cancel: {0}</source>
        <translation>Abbrechen: {0}</translation>
    </message>
</context>
<context>
    <name>JoystickBox</name>
    <message>
        <source>Joystick</source>
        <translation>Joystick</translation>
    </message>
    <message>
        <source>Joysticks are read on Linux only.</source>
        <translation>Joysticks werden nur unter Linux gelesen.</translation>
    </message>
    <message>
        <source>A joystick is there. Click a line, then press the button; click again for none.</source>
        <translation>Ein Joystick ist da. Eine Zeile anklicken, dann die Taste drücken; nochmals klicken für keine.</translation>
    </message>
    <message>
        <source>Click a line, then press a button of the joystick. Return and Land are held, too.</source>
        <translation>Eine Zeile anklicken, dann eine Taste des Joysticks drücken. Heimkehr und Landen werden auch hier gehalten.</translation>
    </message>
    <message>
        <source>Pause</source>
        <translation>Pause</translation>
    </message>
    <message>
        <source>Resume</source>
        <translation>Fortsetzen</translation>
    </message>
    <message>
        <source>Return, held</source>
        <translation>Heimkehr, gehalten</translation>
    </message>
    <message>
        <source>Land, held</source>
        <translation>Landen, gehalten</translation>
    </message>
    <message>
        <source>3-D or map</source>
        <translation>3D oder Karte</translation>
    </message>
    <message>
        <source>Lists</source>
        <translation>Listen</translation>
    </message>
    <message>
        <source>Mute</source>
        <translation>Stumm</translation>
    </message>
    <message>
        <source>Press it ...</source>
        <translation>Drücken ...</translation>
    </message>
    <message>
        <source>none</source>
        <translation>keine</translation>
    </message>
    <message>
        <source>button {0}</source>
        <translation>Taste {0}</translation>
    </message>
</context>
<context>
    <name>LayerList</name>
    <message>
        <source>Show or hide {0}</source>
        <translation>{0} zeigen oder verbergen</translation>
    </message>
    <message>
        <source>Translucent to the left, opaque to the right</source>
        <translation>Links durchscheinend, rechts deckend</translation>
    </message>
    <message>
        <source>Opacity of {0}</source>
        <translation>Deckkraft von {0}</translation>
    </message>
    <message>
        <source>Remove {0} from the map; the file stays</source>
        <translation>{0} von der Karte nehmen; die Datei bleibt</translation>
    </message>
</context>
<context>
    <name>LayerNames</name>
    <message>
        <source>Picture</source>
        <translation>Bild</translation>
    </message>
    <message>
        <source>Diffuse</source>
        <translation>Diffus</translation>
    </message>
    <message>
        <source>Reflectivity</source>
        <translation>Spiegelanteil</translation>
    </message>
    <message>
        <source>Fresnel</source>
        <translation>Fresnel</translation>
    </message>
    <message>
        <source>Reflection</source>
        <translation>Spiegelung</translation>
    </message>
    <message>
        <source>Mirrored light</source>
        <translation>Gespiegeltes Licht</translation>
    </message>
    <message>
        <source>Normals</source>
        <translation>Normalen</translation>
    </message>
    <message>
        <source>Panels</source>
        <translation>Scheiben</translation>
    </message>
    <message>
        <source>Depth</source>
        <translation>Tiefe</translation>
    </message>
    <message>
        <source>Coverage by splats</source>
        <translation>Deckung durch Splats</translation>
    </message>
</context>
<context>
    <name>LightBox</name>
    <message>
        <source>Sun by direction</source>
        <translation>Sonne nach Richtung</translation>
    </message>
    <message>
        <source>Sun by date and time</source>
        <translation>Sonne nach Zeit</translation>
    </message>
    <message>
        <source>Say where the sun stands, or when the photo is taken</source>
        <translation>Angeben, wo die Sonne steht oder wann das Foto entsteht</translation>
    </message>
    <message>
        <source>Heading of the sun</source>
        <translation>Richtung der Sonne</translation>
    </message>
    <message>
        <source>Where the sun stands, clockwise from north</source>
        <translation>Wo die Sonne steht, von Nord im Uhrzeigersinn</translation>
    </message>
    <message>
        <source>Elevation of the sun</source>
        <translation>Höhe der Sonne</translation>
    </message>
    <message>
        <source>How high the sun stands above the horizon</source>
        <translation>Wie hoch die Sonne über dem Horizont steht</translation>
    </message>
    <message>
        <source>Date and time</source>
        <translation>Datum und Uhrzeit</translation>
    </message>
    <message>
        <source>By this computer&apos;s clock and time zone</source>
        <translation>Nach Uhr und Zeitzone dieses Rechners</translation>
    </message>
    <message>
        <source>Simulated surroundings</source>
        <translation>Simulierte Umgebung</translation>
    </message>
    <message>
        <source>Buildings opposite, trees, cars and people, drawn at random; without them the building stands alone</source>
        <translation>Häuser gegenüber, Bäume, Autos und Menschen, ausgelost; ohne sie steht das Gebäude allein</translation>
    </message>
    <message>
        <source>Open a site first: the sun is looked for above it.</source>
        <translation>Zuerst einen Standort öffnen: Die Sonne wird über ihm gesucht.</translation>
    </message>
    <message>
        <source>Sun at {0:.0f}°, {1:.0f}°: below the horizon. No shadows, but a bright sky.</source>
        <translation>Sonne bei {0:.0f}°, {1:.0f}°: untergegangen. Keine Schatten, aber heller Himmel.</translation>
    </message>
    <message>
        <source>Sun at {0:.0f}°, {1:.0f}° high.</source>
        <translation>Sonne bei {0:.0f}°, {1:.0f}° hoch.</translation>
    </message>
</context>
<context>
    <name>LightPage</name>
    <message>
        <source>Ask the scene</source>
        <translation>Szene befragen</translation>
    </message>
    <message>
        <source>Try the cheap models on the photos for some seconds, and say which one is worth it</source>
        <translation>Die günstigen Modelle einige Sekunden an den Fotos versuchen und sagen, welches sich lohnt</translation>
    </message>
    <message>
        <source>as the method has it: {0}</source>
        <translation>wie es das Verfahren hat: {0}</translation>
    </message>
    <message>
        <source>Nothing is known of this scene yet. It is asked when a training begins, or now, which takes seconds.</source>
        <translation>Von dieser Szene ist noch nichts bekannt. Sie wird befragt, wenn ein Training beginnt, oder jetzt, was Sekunden dauert.</translation>
    </message>
    <message>
        <source>It is learned as: {0}.</source>
        <translation>Es wird gelernt als: {0}.</translation>
    </message>
    <message>
        <source>The scene calls for: {0}.</source>
        <translation>Die Szene verlangt: {0}.</translation>
    </message>
</context>
<context>
    <name>LinkBand</name>
    <message>
        <source>SIGNAL LOST. The link is opened again; the aircraft continues by itself.</source>
        <translation>SIGNAL VERLOREN. Die Verbindung wird neu geöffnet; das Fluggerät fliegt selbständig weiter.</translation>
    </message>
    <message>
        <source>SIGNAL LOST for {0:.0f} s. What is shown is old; the aircraft continues by itself.</source>
        <translation>SIGNAL VERLOREN seit {0:.0f} s. Die Anzeige ist alt; das Fluggerät fliegt selbständig weiter.</translation>
    </message>
</context>
<context>
    <name>LiveCamera</name>
    <message>
        <source>What the camera sees</source>
        <translation>Was die Kamera sieht</translation>
    </message>
    <message>
        <source>Camera, drawn</source>
        <translation>Kamera, gezeichnet</translation>
    </message>
    <message>
        <source>The site as the camera should see it, from the pose that the vehicle reports</source>
        <translation>Der Standort, wie die Kamera ihn sehen sollte, aus der Pose, die das Fluggerät meldet</translation>
    </message>
    <message>
        <source>Drawn: no video</source>
        <translation>Gezeichnet: kein Video</translation>
    </message>
    <message>
        <source>Drawn: video awaited</source>
        <translation>Gezeichnet: Video erwartet</translation>
    </message>
    <message>
        <source>Camera, video</source>
        <translation>Kamera, Video</translation>
    </message>
</context>
<context>
    <name>LivePictures</name>
    <message>
        <source>Flown of what is planned</source>
        <translation>Geflogen vom Geplanten</translation>
    </message>
</context>
<context>
    <name>LogBookDialog</name>
    <message>
        <source>Log book</source>
        <translation>Logbuch</translation>
    </message>
    <message>
        <source>Flights of all projects</source>
        <translation>Flüge aller Projekte</translation>
    </message>
    <message>
        <source>Simulated, too</source>
        <translation>Auch simulierte</translation>
    </message>
    <message>
        <source>Flights</source>
        <translation>Flüge</translation>
    </message>
    <message>
        <source>Export as CSV ...</source>
        <translation>Als CSV exportieren ...</translation>
    </message>
    <message>
        <source>Close</source>
        <translation>Schließen</translation>
    </message>
    <message>
        <source>Written: {0}</source>
        <translation>Geschrieben: {0}</translation>
    </message>
    <message>
        <source>Battery {0}: flights: {1}, cycles: {2:.1f}</source>
        <translation>Akku {0}: Flüge: {1}, Zyklen: {2:.1f}</translation>
    </message>
    <message>
        <source>No flights yet; simulated ones: {0}</source>
        <translation>Noch keine Flüge; simulierte: {0}</translation>
    </message>
    <message>
        <source>Tables (*{0})</source>
        <translation>Tabellen (*{0})</translation>
    </message>
    <message>
        <source>Write the log book</source>
        <translation>Logbuch schreiben</translation>
    </message>
    <message>
        <source>Start</source>
        <translation>Start</translation>
    </message>
    <message>
        <source>Time</source>
        <translation>Zeit</translation>
    </message>
    <message>
        <source>Site</source>
        <translation>Standort</translation>
    </message>
    <message>
        <source>Aircraft</source>
        <translation>Fluggerät</translation>
    </message>
    <message>
        <source>Battery</source>
        <translation>Akku</translation>
    </message>
    <message>
        <source>Charge used</source>
        <translation>Ladung verbraucht</translation>
    </message>
    <message>
        <source>Photos</source>
        <translation>Fotos</translation>
    </message>
    <message>
        <source>Findings</source>
        <translation>Befunde</translation>
    </message>
    <message>
        <source>Ended</source>
        <translation>Ende</translation>
    </message>
    <message>
        <source>landed</source>
        <translation>gelandet</translation>
    </message>
</context>
<context>
    <name>LossTerms</name>
    <message>
        <source>colour</source>
        <translation>Farbe</translation>
    </message>
    <message>
        <source>normals and depth</source>
        <translation>Normalen und Tiefe</translation>
    </message>
    <message>
        <source>known normals</source>
        <translation>bekannte Normalen</translation>
    </message>
    <message>
        <source>worst pixels</source>
        <translation>schlechteste Pixel</translation>
    </message>
</context>
<context>
    <name>MachineTexts</name>
    <message>
        <source>Memory is short: up to {0} are needed, and {1} are free. The system may end the training; its last state is kept. Close other programs, or prepare the data set with smaller photos.</source>
        <translation>Der Speicher ist knapp: bis zu {0} werden gebraucht, {1} sind frei. Das System kann das Training beenden; sein letzter Stand bleibt erhalten. Schließen Sie andere Programme, oder bereiten Sie den Datensatz mit kleineren Fotos auf.</translation>
    </message>
    <message>
        <source>Only {0} are free on the disk. States and models are written beside the old ones; make room, or choose another folder.</source>
        <translation>Auf dem Datenträger sind nur {0} frei. Stände und Modelle werden neben die alten geschrieben; schaffen Sie Platz, oder wählen Sie einen anderen Ordner.</translation>
    </message>
    <message>
        <source>{0} cores</source>
        <translation>{0} Kerne</translation>
    </message>
    <message>
        <source>, {0} of memory</source>
        <translation>, {0} Speicher</translation>
    </message>
    <message>
        <source>, {0} of it free</source>
        <translation>, {0} davon frei</translation>
    </message>
    <message>
        <source>Looking for a CUDA device ...</source>
        <translation>Ein CUDA-Gerät wird gesucht ...</translation>
    </message>
    <message>
        <source>No CUDA device: models are learned by one core of the processor.</source>
        <translation>Kein CUDA-Gerät: Modelle lernt ein Kern des Prozessors.</translation>
    </message>
    <message>
        <source>The times to choose from are meant for that. A step of splats alone, 20 000 of them on 256 x 192 pixels, takes about 75 ms; with mirrored light or more pixels it takes longer.</source>
        <translation>Die Zeiten zur Wahl sind dafür gemeint. Ein Schritt mit Splats allein, 20 000 davon auf 256 x 192 Pixeln, dauert etwa 75 ms; mit gespiegeltem Licht oder mehr Pixeln dauert er länger.</translation>
    </message>
    <message>
        <source>CUDA device: {0}</source>
        <translation>CUDA-Gerät: {0}</translation>
    </message>
    <message>
        <source>It is not used: the processor is chosen.</source>
        <translation>Es wird nicht benutzt: der Prozessor ist gewählt.</translation>
    </message>
    <message>
        <source>{0} photos of {1} x {2} pixels take {3} of memory when they are decoded.</source>
        <translation>{0} Fotos von {1} x {2} Pixeln brauchen dekodiert {3} Speicher.</translation>
    </message>
    <message>
        <source>All of them fit, and each is read once.</source>
        <translation>Alle haben Platz, und jedes wird einmal gelesen.</translation>
    </message>
    <message>
        <source>They are streamed through at most {0}: each is looked at four times while it is at hand, then others take its place.</source>
        <translation>Sie laufen durch höchstens {0}: jedes wird viermal angesehen, solange es da ist, dann nehmen andere seinen Platz ein.</translation>
    </message>
    <message>
        <source>Less memory is taken than usual ({0}), for little is free.</source>
        <translation>Es wird weniger Speicher genommen als üblich ({0}), denn wenig ist frei.</translation>
    </message>
    <message>
        <source>All in all a training takes up to {0}; {1} of it are the program&apos;s.</source>
        <translation>Alles in allem braucht ein Training bis zu {0}; {1} davon sind das Programm.</translation>
    </message>
</context>
<context>
    <name>MainWindow</name>
    <message>
        <source>{0} (Ctrl+{1})</source>
        <translation>{0} (Strg+{1})</translation>
    </message>
    <message>
        <source>Done. {0}</source>
        <translation>Erledigt. {0}</translation>
    </message>
</context>
<context>
    <name>ManualWindow</name>
    <message>
        <source>Manual</source>
        <translation>Handbuch</translation>
    </message>
    <message>
        <source>Back</source>
        <translation>Zurück</translation>
    </message>
    <message>
        <source>Contents of the manual</source>
        <translation>Inhalt des Handbuchs</translation>
    </message>
    <message>
        <source>Page of the manual</source>
        <translation>Seite des Handbuchs</translation>
    </message>
    <message>
        <source>Search the manual</source>
        <translation>Handbuch durchsuchen</translation>
    </message>
    <message>
        <source>More</source>
        <translation>Mehr</translation>
    </message>
    <message>
        <source>Words</source>
        <translation>Begriffe</translation>
    </message>
    <message>
        <source>Nothing found.</source>
        <translation>Nichts gefunden.</translation>
    </message>
</context>
<context>
    <name>MapLayers</name>
    <message>
        <source>Sortie {0}</source>
        <translation>Einsatz {0}</translation>
    </message>
    <message>
        <source>Site</source>
        <translation>Standort</translation>
    </message>
    <message>
        <source>Geo-zones</source>
        <translation>Geozonen</translation>
    </message>
    <message>
        <source>Online map</source>
        <translation>Onlinekarte</translation>
    </message>
</context>
<context>
    <name>MapView</name>
    <message>
        <source>Map</source>
        <translation>Karte</translation>
    </message>
    <message>
        <source>This place lies beyond the end of web maps (85.05 degrees).</source>
        <translation>Dieser Ort liegt jenseits des Endes von Webkarten (85,05 Grad).</translation>
    </message>
    <message>
        <source>This site lies beyond the end of web maps (85.05 degrees); use the 3-D view.</source>
        <translation>Dieser Standort liegt jenseits des Randes von Webkarten (85.05 Grad); die 3D-Ansicht nutzen.</translation>
    </message>
    <message>
        <source>Open or import a site on the Site tab, or a map with “Map file”; no network is used.</source>
        <translation>Im Reiter Standort einen Standort öffnen oder importieren, oder mit „Kartendatei“ eine Karte; ein Netz wird nicht benutzt.</translation>
    </message>
    <message>
        <source>No map is loaded. &quot;Map file&quot; opens one (MBTiles, PMTiles); no network is used.</source>
        <translation>Keine Karte ist geladen. „Kartendatei“ öffnet eine (MBTiles, PMTiles); kein Netz wird benutzt.</translation>
    </message>
    <message>
        <source>The map &quot;{0}&quot; does not cover this place.</source>
        <translation>Die Karte „{0}“ enthält diesen Ort nicht.</translation>
    </message>
    <message>
        <source>Find coordinates, UTM, MGRS</source>
        <translation>Koordinaten, UTM, MGRS suchen</translation>
    </message>
    <message>
        <source>Find a place by its coordinates</source>
        <translation>Einen Ort nach Koordinaten suchen</translation>
    </message>
    <message>
        <source>Coordinates of a place (WGS 84), then Enter</source>
        <translation>Koordinaten eines Orts (WGS 84), dann Eingabetaste</translation>
    </message>
    <message>
        <source>Layers</source>
        <translation>Ebenen</translation>
    </message>
    <message>
        <source>Overlay ...</source>
        <translation>Auflage ...</translation>
    </message>
    <message>
        <source>Put GeoJSON, KML, KMZ or GeoTIFF on the map</source>
        <translation>GeoJSON, KML, KMZ oder GeoTIFF auf die Karte legen</translation>
    </message>
    <message>
        <source>Online map ...</source>
        <translation>Onlinekarte ...</translation>
    </message>
    <message>
        <source>A server for map tiles; off until you agree</source>
        <translation>Ein Server für Kartenkacheln; aus, bis Sie zustimmen</translation>
    </message>
    <message>
        <source>Nearer (+)</source>
        <translation>Näher (+)</translation>
    </message>
    <message>
        <source>Further away (-)</source>
        <translation>Weiter weg (-)</translation>
    </message>
    <message>
        <source>Fit</source>
        <translation>Einpassen</translation>
    </message>
    <message>
        <source>Show the whole site (F)</source>
        <translation>Ganzen Standort zeigen (F)</translation>
    </message>
    <message>
        <source>Map file</source>
        <translation>Kartendatei</translation>
    </message>
    <message>
        <source>Open a map file (MBTiles or PMTiles) to put under the site</source>
        <translation>Eine Kartendatei (MBTiles oder PMTiles) unter den Standort legen</translation>
    </message>
    <message>
        <source>What is shown on the map, and how strongly; overlays and the online map</source>
        <translation>Was auf der Karte zu sehen ist und wie kräftig; Auflagen und die Onlinekarte</translation>
    </message>
    <message>
        <source>Overlay for the map</source>
        <translation>Auflage für die Karte</translation>
    </message>
    <message>
        <source>Overlays ({0})</source>
        <translation>Auflagen ({0})</translation>
    </message>
    <message>
        <source>{0}: not kept out of</source>
        <translation>{0}: wird nicht gemieden</translation>
    </message>
    <message>
        <source>Offline maps (*.mbtiles *.pmtiles);;All files (*)</source>
        <translation>Offlinekarten (*.mbtiles *.pmtiles);;Alle Dateien (*)</translation>
    </message>
    <message>
        <source>Open map</source>
        <translation>Karte öffnen</translation>
    </message>
</context>
<context>
    <name>Menus</name>
    <message>
        <source>&amp;Project</source>
        <translation>&amp;Projekt</translation>
    </message>
    <message>
        <source>&amp;Edit</source>
        <translation>&amp;Bearbeiten</translation>
    </message>
    <message>
        <source>&amp;View</source>
        <translation>&amp;Ansicht</translation>
    </message>
    <message>
        <source>&amp;Go</source>
        <translation>&amp;Gehe zu</translation>
    </message>
    <message>
        <source>&amp;Help</source>
        <translation>&amp;Hilfe</translation>
    </message>
    <message>
        <source>Undo</source>
        <translation>Rückgängig</translation>
    </message>
    <message>
        <source>Redo</source>
        <translation>Wiederholen</translation>
    </message>
    <message>
        <source>Save</source>
        <translation>Speichern</translation>
    </message>
    <message>
        <source>&amp;New project</source>
        <translation>&amp;Neues Projekt</translation>
    </message>
    <message>
        <source>&amp;Open project ...</source>
        <translation>Projekt &amp;öffnen ...</translation>
    </message>
    <message>
        <source>Open &amp;recent</source>
        <translation>&amp;Zuletzt geöffnet</translation>
    </message>
    <message>
        <source>&amp;Save</source>
        <translation>&amp;Speichern</translation>
    </message>
    <message>
        <source>Save &amp;as ...</source>
        <translation>Speichern &amp;unter ...</translation>
    </message>
    <message>
        <source>&amp;Quit</source>
        <translation>&amp;Beenden</translation>
    </message>
    <message>
        <source>&amp;Undo</source>
        <translation>&amp;Rückgängig</translation>
    </message>
    <message>
        <source>&amp;Redo</source>
        <translation>&amp;Wiederholen</translation>
    </message>
    <message>
        <source>&amp;3-D view</source>
        <translation>&amp;3D-Ansicht</translation>
    </message>
    <message>
        <source>&amp;Map</source>
        <translation>&amp;Karte</translation>
    </message>
    <message>
        <source>&amp;Camera preview</source>
        <translation>Ka&amp;meravorschau</translation>
    </message>
    <message>
        <source>As the desktop</source>
        <translation>Wie das System</translation>
    </message>
    <message>
        <source>Light</source>
        <translation>Hell</translation>
    </message>
    <message>
        <source>Dark</source>
        <translation>Dunkel</translation>
    </message>
    <message>
        <source>Bright sun</source>
        <translation>Helle Sonne</translation>
    </message>
    <message>
        <source>Metres</source>
        <translation>Meter</translation>
    </message>
    <message>
        <source>Feet</source>
        <translation>Fuß</translation>
    </message>
    <message>
        <source>&amp;Theme</source>
        <translation>&amp;Design</translation>
    </message>
    <message>
        <source>&amp;Units</source>
        <translation>&amp;Einheiten</translation>
    </message>
    <message>
        <source>Te&amp;xt size</source>
        <translation>S&amp;chriftgröße</translation>
    </message>
    <message>
        <source>&amp;Language</source>
        <translation>&amp;Sprache</translation>
    </message>
    <message>
        <source>Map &amp;tiles ...</source>
        <translation>Kar&amp;tenkacheln ...</translation>
    </message>
    <message>
        <source>Copy all &amp;messages</source>
        <translation>Alle Meldungen k&amp;opieren</translation>
    </message>
    <message>
        <source>&amp;Full screen</source>
        <translation>&amp;Vollbild</translation>
    </message>
    <message>
        <source>&amp;Manual</source>
        <translation>&amp;Handbuch</translation>
    </message>
    <message>
        <source>&amp;Tour</source>
        <translation>&amp;Rundgang</translation>
    </message>
    <message>
        <source>&amp;Shortcuts</source>
        <translation>&amp;Tastenkürzel</translation>
    </message>
    <message>
        <source>&amp;About Reflight</source>
        <translation>&amp;Über Reflight</translation>
    </message>
    <message>
        <source>none yet</source>
        <translation>noch keine</translation>
    </message>
    <message>
        <source>Reflight {0}: ground station for the second flight over a glass facade.</source>
        <translation>Reflight {0}: Bodenstation für den zweiten Flug über eine Glasfassade.</translation>
    </message>
    <message>
        <source>About Reflight</source>
        <translation>Über Reflight</translation>
    </message>
    <message>
        <source>aircraft</source>
        <translation>Fluggerät</translation>
    </message>
    <message>
        <source>mission format</source>
        <translation>Missionsformat</translation>
    </message>
    <message>
        <source>model format</source>
        <translation>Modellformat</translation>
    </message>
    <message>
        <source>training method</source>
        <translation>Trainingsmethode</translation>
    </message>
    <message>
        <source>Plug-ins</source>
        <translation>Erweiterungen</translation>
    </message>
</context>
<context>
    <name>MessageArea</name>
    <message>
        <source>Messages</source>
        <translation>Meldungen</translation>
    </message>
    <message>
        <source>All messages: what holds now, and what was told before</source>
        <translation>Alle Meldungen: was jetzt gilt und was vorher gemeldet wurde</translation>
    </message>
    <message>
        <source>Show place</source>
        <translation>Stelle zeigen</translation>
    </message>
    <message>
        <source>Messages: {0}</source>
        <translation>Meldungen: {0}</translation>
    </message>
    <message>
        <source>Error</source>
        <translation>Fehler</translation>
    </message>
    <message>
        <source>Warning</source>
        <translation>Warnung</translation>
    </message>
    <message>
        <source>Note</source>
        <translation>Hinweis</translation>
    </message>
    <message>
        <source>Done</source>
        <translation>Fertig</translation>
    </message>
</context>
<context>
    <name>MessageSheet</name>
    <message>
        <source>All messages</source>
        <translation>Alle Meldungen</translation>
    </message>
    <message>
        <source>Show place</source>
        <translation>Stelle zeigen</translation>
    </message>
    <message>
        <source>Dismiss</source>
        <translation>Erledigt</translation>
    </message>
    <message>
        <source>The message is read; it stays in the list</source>
        <translation>Die Meldung ist gelesen; in der Liste bleibt sie</translation>
    </message>
    <message>
        <source>Copy all</source>
        <translation>Alle kopieren</translation>
    </message>
    <message>
        <source>Close</source>
        <translation>Schließen</translation>
    </message>
    <message>
        <source>Now</source>
        <translation>Jetzt</translation>
    </message>
    <message>
        <source>nothing to heed</source>
        <translation>nichts zu beachten</translation>
    </message>
    <message>
        <source>Told so far</source>
        <translation>Bisher gemeldet</translation>
    </message>
</context>
<context>
    <name>MethodNames</name>
    <message>
        <source>Optimised (recommended)</source>
        <translation>Optimiert (empfohlen)</translation>
    </message>
    <message>
        <source>Particle swarm (paper)</source>
        <translation>Schwarm (Paper)</translation>
    </message>
    <message>
        <source>Nap-of-the-object grid</source>
        <translation>Konturraster</translation>
    </message>
    <message>
        <source>Orbits</source>
        <translation>Umkreisungen</translation>
    </message>
    <message>
        <source>Drawn by lot</source>
        <translation>Ausgelost</translation>
    </message>
</context>
<context>
    <name>MissionController</name>
    <message>
        <source>Check</source>
        <translation>Prüfen</translation>
    </message>
    <message>
        <source>{0} was read for a site that has changed; import again</source>
        <translation>{0} wurde für einen inzwischen geänderten Standort gelesen; neu importieren</translation>
    </message>
    <message>
        <source>Import {0}</source>
        <translation>{0} importieren</translation>
    </message>
    <message>
        <source>{0} imported, photos: {1}, sorties: {2}</source>
        <translation>{0} importiert, Fotos: {1}, Einsätze: {2}</translation>
    </message>
    <message>
        <source>Import mission</source>
        <translation>Mission importieren</translation>
    </message>
    <message>
        <source>Compare</source>
        <translation>Vergleichen</translation>
    </message>
    <message>
        <source>{0}: {1}</source>
        <translation>{0}: {1}</translation>
    </message>
    <message>
        <source>{0} more findings like these</source>
        <translation>{0} weitere solche Befunde</translation>
    </message>
</context>
<context>
    <name>MissionLists</name>
    <message>
        <source>Waypoints</source>
        <translation>Wegpunkte</translation>
    </message>
    <message>
        <source>Profile</source>
        <translation>Profil</translation>
    </message>
    <message>
        <source>Comparison</source>
        <translation>Vergleich</translation>
    </message>
</context>
<context>
    <name>MissionPage</name>
    <message>
        <source>Import the mission files of one flight</source>
        <translation>Missionsdateien eines Flugs importieren</translation>
    </message>
    <message>
        <source>Compare the plan with mission files</source>
        <translation>Plan mit Missionsdateien vergleichen</translation>
    </message>
    <message>
        <source>Missions ({0});;All files (*)</source>
        <translation>Missionen ({0});;Alle Dateien (*)</translation>
    </message>
    <message>
        <source>Export mission files ...</source>
        <translation>Mission exportieren ...</translation>
    </message>
    <message>
        <source>For DJI, QGroundControl, ...</source>
        <translation>Für DJI, QGroundControl, ...</translation>
    </message>
    <message>
        <source>Send to controller ...</source>
        <translation>Zur Fernsteuerung ...</translation>
    </message>
    <message>
        <source>Onto an SD card or a connected remote controller of DJI, read back and compared</source>
        <translation>Auf eine SD-Karte oder eine angeschlossene DJI-Fernsteuerung, zurückgelesen und verglichen</translation>
    </message>
    <message>
        <source>Import mission files ...</source>
        <translation>Mission importieren ...</translation>
    </message>
    <message>
        <source>Compare with file ...</source>
        <translation>Mit Datei vergleichen ...</translation>
    </message>
    <message>
        <source>Is this file the plan? Shows what differs</source>
        <translation>Ist diese Datei der Plan? Zeigt Abweichungen</translation>
    </message>
    <message>
        <source>Flight brief ...</source>
        <translation>Flugbriefing ...</translation>
    </message>
    <message>
        <source>To print or save as PDF</source>
        <translation>Drucken oder als PDF speichern</translation>
    </message>
    <message>
        <source>SORA ...</source>
        <translation>SORA ...</translation>
    </message>
    <message>
        <source>Ground risk: volumes, buffer and class, as a draft with formulas and sources</source>
        <translation>Bodenrisiko: Volumen, Puffer und Klasse, als Entwurf mit Formeln und Quellen</translation>
    </message>
    <message>
        <source>Check</source>
        <translation>Prüfen</translation>
    </message>
    <message>
        <source>Measure every pre-flight rule again</source>
        <translation>Jede Regel vor dem Flug neu messen</translation>
    </message>
    <message>
        <source>{0}, photos: {1}, batteries: {2}, {3}</source>
        <translation>{0}, Fotos: {1}, Akkus: {2}, {3}</translation>
    </message>
    <message>
        <source>No site</source>
        <translation>Kein Standort</translation>
    </message>
    <message>
        <source>As a plan of this project; without a site, on a bare one of its own</source>
        <translation>Als Plan dieses Projekts; ohne Standort auf einem leeren eigenen</translation>
    </message>
    <message>
        <source>Open or import a site first, on the Site tab.</source>
        <translation>Zuerst im Reiter Standort einen Standort öffnen oder importieren.</translation>
    </message>
    <message>
        <source>No plan</source>
        <translation>Kein Plan</translation>
    </message>
    <message>
        <source>Plan a flight on the Plan tab, or import a mission file.</source>
        <translation>Im Reiter Planung einen Flug planen oder eine Missionsdatei importieren.</translation>
    </message>
    <message>
        <source>{0} is not shown in the view</source>
        <translation>{0} ist in der Ansicht nicht dargestellt</translation>
    </message>
</context>
<context>
    <name>ModelController</name>
    <message>
        <source>Open the model</source>
        <translation>Modell öffnen</translation>
    </message>
    <message>
        <source>Open the model beside it</source>
        <translation>Modell daneben öffnen</translation>
    </message>
    <message>
        <source>Export the model</source>
        <translation>Modell exportieren</translation>
    </message>
    <message>
        <source>The model is written: {0}, {1} MB</source>
        <translation>Das Modell ist geschrieben: {0}, {1} MB</translation>
    </message>
    <message>
        <source>Read what is attached to records</source>
        <translation>Anhänge der Einträge lesen</translation>
    </message>
    <message>
        <source>The process that shows models has ended (exit status {0}); it starts anew.</source>
        <translation>Der Prozess, der Modelle zeigt, ist beendet (Status {0}); er startet neu.</translation>
    </message>
</context>
<context>
    <name>ModelPage</name>
    <message>
        <source>Folder of a model</source>
        <translation>Ordner eines Modells</translation>
    </message>
    <message>
        <source>Save the picture</source>
        <translation>Das Bild sichern</translation>
    </message>
    <message>
        <source>Pictures (*.png)</source>
        <translation>Bilder (*.png)</translation>
    </message>
    <message>
        <source>The picture is written: {0}</source>
        <translation>Das Bild ist geschrieben: {0}</translation>
    </message>
    <message>
        <source>{0} cannot be written; choose another place</source>
        <translation>{0} lässt sich nicht schreiben; einen anderen Ort wählen</translation>
    </message>
    <message>
        <source>Export the model</source>
        <translation>Modell exportieren</translation>
    </message>
    <message>
        <source>Save the report</source>
        <translation>Den Bericht sichern</translation>
    </message>
    <message>
        <source>Documents (*.pdf)</source>
        <translation>Dokumente (*.pdf)</translation>
    </message>
    <message>
        <source>model</source>
        <translation>Modell</translation>
    </message>
    <message>
        <source>The report is written: {0}</source>
        <translation>Der Bericht ist geschrieben: {0}</translation>
    </message>
    <message>
        <source>The model is being opened ...</source>
        <translation>Das Modell wird geöffnet ...</translation>
    </message>
    <message>
        <source>No model is open.</source>
        <translation>Kein Modell geöffnet.</translation>
    </message>
    <message>
        <source>{0}: {1} panels, {2} Gaussians</source>
        <translation>{0}: {1} Scheiben, {2} Gauß-Splats</translation>
    </message>
</context>
<context>
    <name>ModelView</name>
    <message>
        <source>Picture of the model</source>
        <translation>Bild des Modells</translation>
    </message>
</context>
<context>
    <name>NextStepBar</name>
    <message>
        <source>Manual: this tab</source>
        <translation>Handbuch: dieser Reiter</translation>
    </message>
    <message>
        <source>What the manual says of this tab</source>
        <translation>Was das Handbuch über diesen Reiter sagt</translation>
    </message>
    <message>
        <source>What is done, and what comes next</source>
        <translation>Was erledigt ist und was als Nächstes kommt</translation>
    </message>
    <message>
        <source>Done</source>
        <translation>Fertig</translation>
    </message>
    <message>
        <source>Done: {0}.</source>
        <translation>Erledigt: {0}.</translation>
    </message>
    <message>
        <source>Next: {0}.</source>
        <translation>Als Nächstes: {0}.</translation>
    </message>
</context>
<context>
    <name>NoFlyPage</name>
    <message>
        <source>No-fly zone</source>
        <translation>Flugverbotszone</translation>
    </message>
    <message>
        <source>From height</source>
        <translation>Ab Höhe</translation>
    </message>
    <message>
        <source>To height</source>
        <translation>Bis Höhe</translation>
    </message>
    <message>
        <source>Corners</source>
        <translation>Ecken</translation>
    </message>
    <message>
        <source>Change {0}</source>
        <translation>{0} ändern</translation>
    </message>
</context>
<context>
    <name>ObstaclePage</name>
    <message>
        <source>Obstacle</source>
        <translation>Hindernis</translation>
    </message>
    <message>
        <source>Mesh {0}
Size: {1}; triangles: {2}</source>
        <translation>Netz {0}
Größe: {1}; Dreiecke: {2}</translation>
    </message>
    <message>
        <source>Change {0}</source>
        <translation>{0} ändern</translation>
    </message>
</context>
<context>
    <name>OnlineMapDialog</name>
    <message>
        <source>Online map</source>
        <translation>Onlinekarte</translation>
    </message>
    <message>
        <source>© who owns the data, and its licence</source>
        <translation>© wem die Daten gehören, und die Lizenz</translation>
    </message>
    <message>
        <source>Fetch tiles from this server</source>
        <translation>Kacheln von diesem Server holen</translation>
    </message>
    <message>
        <source>Reflight asks this server for the tiles that the map shows, and for nothing else. The server learns which area you look at. Use a server whose terms allow this, and enter the words that it asks for: they stand on the map. Tiles are kept on this computer, for a week where the server does not say otherwise, and are shown without network.</source>
        <translation>Reflight fragt diesen Server nach den Kacheln, die die Karte zeigt, und nach nichts anderem. Der Server erfährt, welches Gebiet Sie ansehen. Nehmen Sie einen Server, dessen Bedingungen das erlauben, und geben Sie die Worte ein, die er verlangt: Sie stehen auf der Karte. Kacheln bleiben auf diesem Rechner, eine Woche lang, wenn der Server nichts anderes sagt, und sind ohne Netz zu sehen.</translation>
    </message>
    <message>
        <source>Address of a tile</source>
        <translation>Adresse einer Kachel</translation>
    </message>
    <message>
        <source>Licence</source>
        <translation>Lizenz</translation>
    </message>
    <message>
        <source>Deepest level</source>
        <translation>Tiefste Stufe</translation>
    </message>
    <message>
        <source>Room for tiles, MB</source>
        <translation>Platz für Kacheln, MB</translation>
    </message>
</context>
<context>
    <name>OriginBox</name>
    <message>
        <source>North positive, WGS 84</source>
        <translation>Nord positiv, WGS 84</translation>
    </message>
    <message>
        <source>East positive, WGS 84</source>
        <translation>Ost positiv, WGS 84</translation>
    </message>
    <message>
        <source>Mean sea level by the EGM96 geoid, as autopilots and DJI use it; good to about a metre</source>
        <translation>Mittlerer Meeresspiegel nach dem Geoid EGM96, wie Autopiloten und DJI ihn nutzen; auf etwa einen Meter genau</translation>
    </message>
    <message>
        <source>Latitude</source>
        <translation>Breitengrad</translation>
    </message>
    <message>
        <source>Longitude</source>
        <translation>Längengrad</translation>
    </message>
    <message>
        <source>Height of the site origin:</source>
        <translation>Höhe des Nullpunkts:</translation>
    </message>
    <message>
        <source>Above ellipsoid</source>
        <translation>Über Ellipsoid</translation>
    </message>
    <message>
        <source>Above sea level</source>
        <translation>Über Meer</translation>
    </message>
</context>
<context>
    <name>Overlay</name>
    <message>
        <source>N</source>
        <translation>N</translation>
    </message>
    <message>
        <source>{0:g} {1} in the middle</source>
        <translation>{0:g} {1} in Bildmitte</translation>
    </message>
    <message>
        <source>no value</source>
        <translation>kein Wert</translation>
    </message>
</context>
<context>
    <name>PaintBar</name>
    <message>
        <source>facade</source>
        <translation>Fassade</translation>
    </message>
    <message>
        <source>coverage</source>
        <translation>Abdeckung</translation>
    </message>
    <message>
        <source>hemispheres</source>
        <translation>Hemisphären</translation>
    </message>
    <message>
        <source>GSD</source>
        <translation>GSD</translation>
    </message>
    <message>
        <source>sortie</source>
        <translation>Einsatz</translation>
    </message>
    <message>
        <source>clearance</source>
        <translation>Abstand</translation>
    </message>
    <message>
        <source>Panels by</source>
        <translation>Scheiben nach</translation>
    </message>
    <message>
        <source>Route by</source>
        <translation>Route nach</translation>
    </message>
</context>
<context>
    <name>PanelDetail</name>
    <message>
        <source>Views of the section</source>
        <translation>Aufnahmen des Sektors</translation>
    </message>
    <message>
        <source>No panel selected</source>
        <translation>Keine Scheibe ausgewählt</translation>
    </message>
    <message>
        <source>Panel {0}</source>
        <translation>Scheibe {0}</translation>
    </message>
    <message>
        <source>What a plan covers of it stands here.</source>
        <translation>Hier steht, was ein Plan davon abdeckt.</translation>
    </message>
    <message>
        <source>{0} of {1} sections covered, {2} possible</source>
        <translation>{0} von {1} Sektoren abgedeckt, {2} erreichbar</translation>
    </message>
    <message>
        <source>; finest pixel {0}</source>
        <translation>; feinstes Pixel {0}</translation>
    </message>
    <message>
        <source>{0:g} to {1:g}° from the normal, {2:g} to {3:g}° around</source>
        <translation>{0:g} bis {1:g}° neben der Normalen, {2:g} bis {3:g}° um sie</translation>
    </message>
    <message>
        <source>covered; views that see it: {0}</source>
        <translation>abgedeckt; Aufnahmen davon: {0}</translation>
    </message>
    <message>
        <source>could be covered, but no view of this plan does</source>
        <translation>erreichbar, aber keine Aufnahme dieses Plans deckt ihn ab</translation>
    </message>
    <message>
        <source>cannot be covered from anywhere allowed</source>
        <translation>von keinem erlaubten Ort erreichbar</translation>
    </message>
    <message>
        <source>not covered; whether it could be is not known</source>
        <translation>nicht abgedeckt; ob erreichbar, ist unbekannt</translation>
    </message>
    <message>
        <source>Click a section to see its views.</source>
        <translation>Einen Sektor anklicken zeigt seine Aufnahmen.</translation>
    </message>
    <message>
        <source>; or </source>
        <translation>; oder </translation>
    </message>
</context>
<context>
    <name>PanelPage</name>
    <message>
        <source>Panel</source>
        <translation>Scheibe</translation>
    </message>
    <message>
        <source>On facade {0}
Size: {1} × {2}
Faces: {3}</source>
        <translation>An Fassade {0}
Größe: {1} × {2}
Blickrichtung: {3}</translation>
    </message>
    <message>
        <source>up</source>
        <translation>nach oben</translation>
    </message>
    <message>
        <source>down</source>
        <translation>nach unten</translation>
    </message>
    <message>
        <source>In the imported file: {0}</source>
        <translation>In der importierten Datei: {0}</translation>
    </message>
    <message>
        <source>Found in photos: corners ± {0:.3g} {1}, confidence {2:.0f} %</source>
        <translation>In Fotos gefunden: Ecken ± {0:.3g} {1}, Sicherheit {2:.0f} %</translation>
    </message>
</context>
<context>
    <name>PanelSide</name>
    <message>
        <source>Open a model ...</source>
        <translation>Modell öffnen ...</translation>
    </message>
    <message>
        <source>Export ...</source>
        <translation>Exportieren ...</translation>
    </message>
    <message>
        <source>Write the model for other programs</source>
        <translation>Das Modell für andere Programme schreiben</translation>
    </message>
    <message>
        <source>Several can be marked, with Ctrl or Shift, for a report</source>
        <translation>Mit Strg oder Umschalt lassen sich mehrere für einen Bericht markieren</translation>
    </message>
    <message>
        <source>Panels</source>
        <translation>Scheiben</translation>
    </message>
    <message>
        <source>Search panels and records</source>
        <translation>Scheiben und Einträge suchen</translation>
    </message>
    <message>
        <source>Colour panels by</source>
        <translation>Scheiben einfärben nach</translation>
    </message>
    <message>
        <source>nothing</source>
        <translation>nichts</translation>
    </message>
    <message>
        <source>last inspection</source>
        <translation>letzter Prüfung</translation>
    </message>
    <message>
        <source>worst open defect</source>
        <translation>schwerstem offenen Schaden</translation>
    </message>
    <message>
        <source>facade</source>
        <translation>Fassade</translation>
    </message>
    <message>
        <source>{0} without a value</source>
        <translation>{0} ohne Wert</translation>
    </message>
</context>
<context>
    <name>PanelSightings</name>
    <message>
        <source>Photos that show the panel</source>
        <translation>Fotos, die die Scheibe zeigen</translation>
    </message>
    <message>
        <source>No panel selected</source>
        <translation>Keine Scheibe ausgewählt</translation>
    </message>
    <message>
        <source>Click a panel in 3-D to see which photos show it.</source>
        <translation>Klicken Sie in 3D auf eine Scheibe, um zu sehen, welche Fotos sie zeigen.</translation>
    </message>
    <message>
        <source>Panel {0}</source>
        <translation>Scheibe {0}</translation>
    </message>
    <message>
        <source>section {0}: {1}</source>
        <translation>Sektor {0}: {1}</translation>
    </message>
    <message>
        <source>Photos that show it: {0}; sections: {1}</source>
        <translation>Fotos, die sie zeigen: {0}; Sektoren: {1}</translation>
    </message>
    <message>
        <source>Sections that no photo shows: {0}</source>
        <translation>Sektoren, die kein Foto zeigt: {0}</translation>
    </message>
    <message>
        <source>Promised and on no photo: {0} ({1})</source>
        <translation>Versprochen und auf keinem Foto: {0} ({1})</translation>
    </message>
    <message>
        <source>Everything that the plan promised is on photos.</source>
        <translation>Alles, was der Plan versprach, ist auf Fotos.</translation>
    </message>
    <message>
        <source>Only photos of section {0} are listed; press it again for all.</source>
        <translation>Nur Fotos von Sektor {0} sind aufgeführt; noch ein Druck darauf zeigt alle.</translation>
    </message>
    <message>
        <source>photos that show it: {0}</source>
        <translation>Fotos, die ihn zeigen: {0}</translation>
    </message>
    <message>
        <source>promised by the plan, but on no photo</source>
        <translation>vom Plan versprochen, aber auf keinem Foto</translation>
    </message>
    <message>
        <source>on no photo</source>
        <translation>auf keinem Foto</translation>
    </message>
</context>
<context>
    <name>Parameters</name>
    <message>
        <source>Method</source>
        <translation>Verfahren</translation>
    </message>
    <message>
        <source>how views are chosen</source>
        <translation>wie Aufnahmen gewählt werden</translation>
    </message>
    <message>
        <source>Views</source>
        <translation>Aufnahmen</translation>
    </message>
    <message>
        <source>number of views</source>
        <translation>Zahl der Aufnahmen</translation>
    </message>
    <message>
        <source>share of what can be covered, 0 to 1, with as few views as possible</source>
        <translation>Anteil dessen, was abgedeckt werden kann, 0 bis 1, mit möglichst wenigen Aufnahmen</translation>
    </message>
    <message>
        <source>Batteries</source>
        <translation>Akkus</translation>
    </message>
    <message>
        <source>number of sorties: as much as can be covered within them</source>
        <translation>Zahl der Flüge: so viel, wie in ihnen abgedeckt werden kann</translation>
    </message>
    <message>
        <source>Worth another battery</source>
        <translation>Wert für weiteren Akku</translation>
    </message>
    <message>
        <source>as many batteries as are worth it: until another would bring unseen views less than so many dB more</source>
        <translation>so viele Akkus, wie es sich lohnt: bis ein weiterer ungesehenen Ansichten weniger als so viele dB mehr brächte</translation>
    </message>
    <message>
        <source>Aircraft</source>
        <translation>Fluggerät</translation>
    </message>
    <message>
        <source>aircraft and camera, or a .toml file with your own</source>
        <translation>Fluggerät und Kamera, oder eine .toml-Datei mit eigenen</translation>
    </message>
    <message>
        <source>Safety distance</source>
        <translation>Mindestabstand</translation>
    </message>
    <message>
        <source>of every view and path to everything solid</source>
        <translation>jeder Aufnahme und jedes Wegs zu allem Festen</translation>
    </message>
    <message>
        <source>Section step</source>
        <translation>Sektorweite</translation>
    </message>
    <message>
        <source>width of the hemisphere sections</source>
        <translation>Breite der Abschnitte der Halbkugeln</translation>
    </message>
    <message>
        <source>Count whole panels only</source>
        <translation>Nur ganze Scheiben</translation>
    </message>
    <message>
        <source>a view counts only when all four corners of a panel are in the picture, not just its middle</source>
        <translation>eine Aufnahme zählt nur, wenn alle vier Ecken einer Scheibe im Bild sind, nicht nur ihre Mitte</translation>
    </message>
    <message>
        <source>each direction of view is wanted with pixels up to this size on the panel; those seen only more coarsely are counted and named</source>
        <translation>jede Blickrichtung ist mit Pixeln bis zu dieser Größe auf der Scheibe gewünscht; gröber gesehene werden gezählt und genannt</translation>
    </message>
    <message>
        <source>Battery reserve</source>
        <translation>Akkureserve</translation>
    </message>
    <message>
        <source>part of the battery that is left at landing</source>
        <translation>Teil des Akkus, der bei der Landung übrig ist</translation>
    </message>
    <message>
        <source>Hover before photo</source>
        <translation>Halt vor Foto</translation>
    </message>
    <message>
        <source>hover between the end of all turning and the shutter</source>
        <translation>Schweben zwischen dem Ende aller Drehungen und dem Auslösen</translation>
    </message>
    <message>
        <source>Wind</source>
        <translation>Wind</translation>
    </message>
    <message>
        <source>steady wind that is expected, from the worst direction</source>
        <translation>erwarteter gleichmäßiger Wind, aus der ungünstigsten Richtung</translation>
    </message>
    <message>
        <source>Views are chosen for</source>
        <translation>Ansichten gewählt für</translation>
    </message>
    <message>
        <source>what a number of views or batteries is spent on: pictures of a model that are near to the truth, or the paper&apos;s count of hemisphere sections</source>
        <translation>wofür eine Anzahl von Ansichten oder Akkus ausgegeben wird: Bilder eines Modells nahe an der Wahrheit, oder die Hemisphärenabschnitte, die der Artikel zählt</translation>
    </message>
    <message>
        <source>the model&apos;s pictures</source>
        <translation>die Bilder des Modells</translation>
    </message>
    <message>
        <source>hemisphere sections</source>
        <translation>Hemisphärenabschnitte</translation>
    </message>
    <message>
        <source>Weight by solid angle</source>
        <translation>Raumwinkel gewichten</translation>
    </message>
    <message>
        <source>Target coverage</source>
        <translation>Zielabdeckung</translation>
    </message>
    <message>
        <source>Wanted GSD</source>
        <translation>Gewünschte GSD</translation>
    </message>
    <message>
        <source>Aircraft at once</source>
        <translation>Fluggeräte zugleich</translation>
    </message>
    <message>
        <source>sorties that are in the air at the same time, each with an aircraft of its own</source>
        <translation>Einsätze, die zugleich in der Luft sind, jeder mit eigenem Fluggerät</translation>
    </message>
    <message>
        <source>weight hemisphere sections by their solid angle instead of equally</source>
        <translation>Abschnitte der Halbkugeln nach ihrem Raumwinkel gewichten statt alle gleich</translation>
    </message>
    <message>
        <source>Precision</source>
        <translation>Genauigkeit</translation>
    </message>
    <message>
        <source>of the coverage kernel</source>
        <translation>der Abdeckungsrechnung</translation>
    </message>
    <message>
        <source>single (fast)</source>
        <translation>einfach (schnell)</translation>
    </message>
    <message>
        <source>double (slower)</source>
        <translation>doppelt (langsamer)</translation>
    </message>
    <message>
        <source>Seed</source>
        <translation>Startwert</translation>
    </message>
    <message>
        <source>of everything random</source>
        <translation>von allem Zufälligen</translation>
    </message>
    <message>
        <source>Time to plan</source>
        <translation>Planungszeit</translation>
    </message>
    <message>
        <source>longest wall time for the whole plan; the search ends earlier when it finds nothing more</source>
        <translation>längste Zeit für den ganzen Plan; die Suche endet früher, wenn sie nichts mehr findet</translation>
    </message>
    <message>
        <source>mean wind at the height of a mast (6 m)</source>
        <translation>mittlerer Wind in der Höhe eines Masts (6 m)</translation>
    </message>
    <message>
        <source>Wind from</source>
        <translation>Wind aus</translation>
    </message>
    <message>
        <source>where the wind comes from, clockwise from north</source>
        <translation>woher der Wind kommt, im Uhrzeigersinn von Norden</translation>
    </message>
    <message>
        <source>GNSS</source>
        <translation>GNSS</translation>
    </message>
    <message>
        <source>what the GNSS receiver reaches under open sky</source>
        <translation>was der GNSS-Empfänger unter freiem Himmel erreicht</translation>
    </message>
    <message>
        <source>RTK fixed</source>
        <translation>RTK fixiert</translation>
    </message>
    <message>
        <source>RTK float</source>
        <translation>RTK Float</translation>
    </message>
    <message>
        <source>without RTK</source>
        <translation>ohne RTK</translation>
    </message>
    <message>
        <source>Heights in the file</source>
        <translation>Höhen in der Datei</translation>
    </message>
    <message>
        <source>reference of heights in the file</source>
        <translation>Bezug der Höhen in der Datei</translation>
    </message>
    <message>
        <source>above take-off</source>
        <translation>über Startplatz</translation>
    </message>
    <message>
        <source>above sea level (EGM96)</source>
        <translation>über Meer (EGM96)</translation>
    </message>
    <message>
        <source>above ellipsoid (WGS 84)</source>
        <translation>über Ellipsoid (WGS 84)</translation>
    </message>
    <message>
        <source>Autopilot</source>
        <translation>Autopilot</translation>
    </message>
    <message>
        <source>whose rules MAVLink files follow</source>
        <translation>wessen Regeln MAVLink-Dateien folgen</translation>
    </message>
    <message>
        <source>ArduPilot</source>
        <translation>ArduPilot</translation>
    </message>
    <message>
        <source>PX4</source>
        <translation>PX4</translation>
    </message>
    <message>
        <source>by aircraft</source>
        <translation>nach Fluggerät</translation>
    </message>
    <message>
        <source>Without radio link</source>
        <translation>Ohne Funkverbindung</translation>
    </message>
    <message>
        <source>DJI: what to do without radio link</source>
        <translation>DJI: was ohne Funkverbindung geschieht</translation>
    </message>
    <message>
        <source>continue mission</source>
        <translation>Mission fortsetzen</translation>
    </message>
    <message>
        <source>return home straight</source>
        <translation>direkt zum Startplatz zurück</translation>
    </message>
    <message>
        <source>Return height</source>
        <translation>Rückkehrhöhe</translation>
    </message>
    <message>
        <source>DJI: of the return above take-off, 20 to 1500</source>
        <translation>DJI: der Rückkehr über dem Startplatz, 20 bis 1500</translation>
    </message>
    <message>
        <source>Colours</source>
        <translation>Farben</translation>
    </message>
    <message>
        <source>what panels mirror is baked into their colours, for programs that mirror nothing, or panels have their own</source>
        <translation>was die Scheiben spiegeln, ist in ihre Farben gerechnet, für Programme ohne Spiegelung; oder sie haben ihre eigenen</translation>
    </message>
    <message>
        <source>with what panels mirror</source>
        <translation>mit dem, was Scheiben spiegeln</translation>
    </message>
    <message>
        <source>panels&apos; own colours</source>
        <translation>eigene Farben der Scheiben</translation>
    </message>
    <message>
        <source>Degree of colours</source>
        <translation>Grad der Farben</translation>
    </message>
    <message>
        <source>of the harmonics by which colours depend on the direction</source>
        <translation>der Harmonischen, mit denen Farben von der Richtung abhängen</translation>
    </message>
    <message>
        <source>File size</source>
        <translation>Dateigröße</translation>
    </message>
    <message>
        <source>of spz, spz-4, sog and Gaussians that are compressed: how small</source>
        <translation>bei spz, spz-4, sog und komprimierten Gauß-Splats: wie klein</translation>
    </message>
    <message>
        <source>small</source>
        <translation>klein</translation>
    </message>
    <message>
        <source>balanced</source>
        <translation>ausgewogen</translation>
    </message>
    <message>
        <source>fine</source>
        <translation>fein</translation>
    </message>
    <message>
        <source>Gaussians</source>
        <translation>Gauß-Splats</translation>
    </message>
    <message>
        <source>of gltf (by itself numbers) and 3d-tiles (by itself spz): as numbers; compressed, as CesiumJS wants them; or coloured points in their place</source>
        <translation>bei gltf (sonst Zahlen) und 3d-tiles (sonst spz): als Zahlen; komprimiert, wie CesiumJS sie will; oder farbige Punkte an ihrer Stelle</translation>
    </message>
    <message>
        <source>as numbers</source>
        <translation>als Zahlen</translation>
    </message>
    <message>
        <source>compressed</source>
        <translation>komprimiert</translation>
    </message>
    <message>
        <source>as coloured points</source>
        <translation>als farbige Punkte</translation>
    </message>
    <message>
        <source>as the format has it</source>
        <translation>wie im Format üblich</translation>
    </message>
    <message>
        <source>Time</source>
        <translation>Zeit</translation>
    </message>
    <message>
        <source>how long one can wait</source>
        <translation>wie lange man warten kann</translation>
    </message>
    <message>
        <source>10 minutes</source>
        <translation>10 Minuten</translation>
    </message>
    <message>
        <source>1 hour</source>
        <translation>1 Stunde</translation>
    </message>
    <message>
        <source>overnight, 10 hours</source>
        <translation>über Nacht, 10 Stunden</translation>
    </message>
    <message>
        <source>what is trained, and how</source>
        <translation>was trainiert wird, und wie</translation>
    </message>
    <message>
        <source>Mirrored light is learned as</source>
        <translation>Gespiegeltes Licht wird gelernt als</translation>
    </message>
    <message>
        <source>what mirrored light is learned with</source>
        <translation>womit gespiegeltes Licht gelernt wird</translation>
    </message>
    <message>
        <source>as the scene calls for</source>
        <translation>wie es die Szene verlangt</translation>
    </message>
    <message>
        <source>none apart from the splats (harmonics)</source>
        <translation>keines neben den Splats (Kugelfunktionen)</translation>
    </message>
    <message>
        <source>far away (environment map)</source>
        <translation>weit entfernt (Umgebungsbild)</translation>
    </message>
    <message>
        <source>network by place and direction (paper)</source>
        <translation>Netz nach Ort und Richtung (Veröffentlichung)</translation>
    </message>
    <message>
        <source>near things (radiance grid)</source>
        <translation>nahe Dinge (Strahlungsgitter)</translation>
    </message>
    <message>
        <source>Compute on</source>
        <translation>Rechnen auf</translation>
    </message>
    <message>
        <source>what to compute on; cuda needs the extra of that name</source>
        <translation>worauf gerechnet wird; cuda braucht das gleichnamige Extra</translation>
    </message>
    <message>
        <source>the processor</source>
        <translation>dem Prozessor</translation>
    </message>
    <message>
        <source>People below</source>
        <translation>Menschen darunter</translation>
    </message>
    <message>
        <source>people below: a word of SORA, or people per square kilometre</source>
        <translation>Menschen darunter: ein Wort von SORA, oder Menschen je Quadratkilometer</translation>
    </message>
    <message>
        <source>strongest wind in which it flies, from any side</source>
        <translation>stärkster Wind, in dem es fliegt, von jeder Seite</translation>
    </message>
    <message>
        <source>Reaction</source>
        <translation>Reaktion</translation>
    </message>
    <message>
        <source>from leaving the flight geography until the pilot acts</source>
        <translation>vom Verlassen der Fluggeographie, bis der Pilot handelt</translation>
    </message>
    <message>
        <source>Full speed</source>
        <translation>Volle Geschwindigkeit</translation>
    </message>
    <message>
        <source>fastest level flight through the air, where a mode limits it</source>
        <translation>schnellster Horizontalflug durch die Luft, wo ein Modus ihn begrenzt</translation>
    </message>
    <message>
        <source>Braking tilt</source>
        <translation>Neigung beim Bremsen</translation>
    </message>
    <message>
        <source>tilt with which it brakes</source>
        <translation>Neigung, mit der es bremst</translation>
    </message>
    <message>
        <source>Largest dimension</source>
        <translation>Größte Abmessung</translation>
    </message>
    <message>
        <source>longest line between two points of the aircraft, propellers included</source>
        <translation>längste Strecke zwischen zwei Punkten des Fluggeräts, mit Propellern</translation>
    </message>
    <message>
        <source>Take-off mass in kg</source>
        <translation>Startmasse in kg</translation>
    </message>
    <message>
        <source>largest take-off mass in kilograms</source>
        <translation>größte Startmasse in Kilogramm</translation>
    </message>
    <message>
        <source>GNSS error</source>
        <translation>GNSS-Fehler</translation>
    </message>
    <message>
        <source>error of the position; near glass, reflected signals can make it larger</source>
        <translation>Fehler der Position; nahe an Glas können gespiegelte Signale ihn vergrößern</translation>
    </message>
    <message>
        <source>Position hold error</source>
        <translation>Fehler beim Halten der Position</translation>
    </message>
    <message>
        <source>how far it strays from the place that it holds</source>
        <translation>wie weit es von der gehaltenen Stelle abweicht</translation>
    </message>
    <message>
        <source>Map error</source>
        <translation>Kartenfehler</translation>
    </message>
    <message>
        <source>error of the map or site on which the paths were planned</source>
        <translation>Fehler der Karte oder des Standorts, auf dem die Pfade geplant wurden</translation>
    </message>
    <message>
        <source>Height by</source>
        <translation>Höhe durch</translation>
    </message>
    <message>
        <source>what the aircraft measures its height with</source>
        <translation>womit das Fluggerät seine Höhe misst</translation>
    </message>
    <message>
        <source>barometer</source>
        <translation>Barometer</translation>
    </message>
    <message>
        <source>Flight geography</source>
        <translation>Fluggeographie</translation>
    </message>
    <message>
        <source>flight geography: the hull of all paths, in which straight returns home stay, or the paths alone</source>
        <translation>Fluggeographie: die Hülle aller Pfade, in der gerade Rückkehren bleiben, oder die Pfade allein</translation>
    </message>
    <message>
        <source>hull of all paths</source>
        <translation>Hülle aller Pfade</translation>
    </message>
    <message>
        <source>paths alone</source>
        <translation>Pfade allein</translation>
    </message>
    <message>
        <source>Buffer</source>
        <translation>Puffer</translation>
    </message>
    <message>
        <source>ground-risk buffer: as far as the aircraft falls, or as wide as it flies high (1:1)</source>
        <translation>Bodenrisikopuffer: so weit das Fluggerät fällt, oder so breit, wie es hoch fliegt (1:1)</translation>
    </message>
    <message>
        <source>as far as it falls</source>
        <translation>so weit es fällt</translation>
    </message>
    <message>
        <source>as wide as high (1:1)</source>
        <translation>so breit wie hoch (1:1)</translation>
    </message>
    <message>
        <source>M1(A) sheltering</source>
        <translation>M1(A) Schutz durch Gebäude</translation>
    </message>
    <message>
        <source>M1(A): people are in buildings that the aircraft does not get into</source>
        <translation>M1(A): Menschen sind in Gebäuden, in die das Fluggerät nicht eindringt</translation>
    </message>
    <message>
        <source>M1(B) restrictions</source>
        <translation>M1(B) Einschränkungen</translation>
    </message>
    <message>
        <source>M1(B): place or time of the flight have fewer people there</source>
        <translation>M1(B): Ort oder Zeit des Fluges haben weniger Menschen dort</translation>
    </message>
    <message>
        <source>M1(C) ground observation</source>
        <translation>M1(C) Bodenbeobachtung</translation>
    </message>
    <message>
        <source>M1(C): somebody watches the ground and the flight keeps away from people</source>
        <translation>M1(C): jemand beobachtet den Boden, und der Flug hält sich von Menschen fern</translation>
    </message>
    <message>
        <source>M2 softer impact</source>
        <translation>M2 milderer Aufprall</translation>
    </message>
    <message>
        <source>M2: what lessens the blow, such as a parachute</source>
        <translation>M2: was den Aufprall mildert, etwa ein Fallschirm</translation>
    </message>
    <message>
        <source>Arc tolerance</source>
        <translation>Bogentoleranz</translation>
    </message>
    <message>
        <source>how much wider than exact the corners of the areas may be; less has more corners</source>
        <translation>wie viel weiter als genau die Ecken der Gebiete sein dürfen; weniger hat mehr Ecken</translation>
    </message>
</context>
<context>
    <name>PassphraseDialog</name>
    <message>
        <source>Set the signing passphrase</source>
        <translation>Passphrase für die Signatur setzen</translation>
    </message>
    <message>
        <source>The key is made of the passphrase, as other ground stations make it: the same passphrase is the same key there. It is kept for you alone on this computer, never in a project, and replaces the one before.</source>
        <translation>Der Schlüssel wird aus der Passphrase gemacht, wie andere Bodenstationen es tun: Dieselbe Passphrase ist dort derselbe Schlüssel. Er liegt nur für Sie auf diesem Rechner, nie in einem Projekt, und ersetzt den bisherigen.</translation>
    </message>
    <message>
        <source>Passphrase</source>
        <translation>Passphrase</translation>
    </message>
    <message>
        <source>Once more</source>
        <translation>Noch einmal</translation>
    </message>
    <message>
        <source>It needs {0} characters or more: short ones are guessed.</source>
        <translation>Sie braucht mindestens {0} Zeichen: kurze werden erraten.</translation>
    </message>
    <message>
        <source>The two are not the same yet.</source>
        <translation>Beide stimmen noch nicht überein.</translation>
    </message>
</context>
<context>
    <name>PhotoBox</name>
    <message>
        <source>Lines</source>
        <translation>Linien</translation>
    </message>
    <message>
        <source>Photo</source>
        <translation>Foto</translation>
    </message>
    <message>
        <source>Building, panels and what is covered, drawn at once</source>
        <translation>Gebäude, Scheiben und was abgedeckt ist, sofort gezeichnet</translation>
    </message>
    <message>
        <source>As photographed: what the glass will mirror from here</source>
        <translation>Wie fotografiert: was das Glas von hier aus spiegeln wird</translation>
    </message>
    <message>
        <source>Outlines</source>
        <translation>Umrisse</translation>
    </message>
    <message>
        <source>Panels&apos; outlines over the photo, thick where this view covers them</source>
        <translation>Umrisse der Scheiben über dem Foto, dick, wo diese Aufnahme sie abdeckt</translation>
    </message>
    <message>
        <source>Effects ...</source>
        <translation>Effekte ...</translation>
    </message>
    <message>
        <source>What is simulated in this photo, what is not, and why</source>
        <translation>Was in diesem Foto simuliert ist, was nicht, und warum</translation>
    </message>
</context>
<context>
    <name>PhotoController</name>
    <message>
        <source>This site has no panels yet, and nothing to mirror in them.</source>
        <translation>Dieser Standort hat noch keine Scheiben, in denen sich etwas spiegeln könnte.</translation>
    </message>
    <message>
        <source>The photo waits for: {0}</source>
        <translation>Das Foto wartet auf: {0}</translation>
    </message>
    <message>
        <source>Render the photo</source>
        <translation>Foto rendern</translation>
    </message>
    <message>
        <source>The photo could not be rendered: {0}</source>
        <translation>Das Foto ließ sich nicht rendern: {0}</translation>
    </message>
    <message>
        <source>The photo was cancelled; choose Photo again to render it.</source>
        <translation>Das Foto wurde abgebrochen; „Foto“ noch einmal wählen, um es zu rendern.</translation>
    </message>
    <message>
        <source>The camera stands inside something here: a building opposite, a tree or an obstacle. Take the made-up street away, or move the viewpoint.</source>
        <translation>Die Kamera steht hier in etwas darin: in einem Haus gegenüber, einem Baum oder Hindernis. Die erdachte Straße wegnehmen oder den Aufnahmepunkt verschieben.</translation>
    </message>
    <message>
        <source>Coarse picture; the fine one follows.</source>
        <translation>Grobes Bild; das feine folgt.</translation>
    </message>
    <message>
        <source>{0} ({1:.0f} %)</source>
        <translation>{0} ({1:.0f} %)</translation>
    </message>
</context>
<context>
    <name>PhotoOverlay</name>
    <message>
        <source>horizon</source>
        <translation>Horizont</translation>
    </message>
</context>
<context>
    <name>PhotoPane</name>
    <message>
        <source>Photo</source>
        <translation>Foto</translation>
    </message>
    <message>
        <source>Rectified</source>
        <translation>Entzerrt</translation>
    </message>
    <message>
        <source>Coverage in 3-D</source>
        <translation>Abdeckung in 3D</translation>
    </message>
    <message>
        <source>The panels coloured by what the photos show of them; a click tells which</source>
        <translation>Die Scheiben gefärbt nach dem, was die Fotos von ihnen zeigen; ein Klick sagt, welche</translation>
    </message>
    <message>
        <source>Fit</source>
        <translation>Einpassen</translation>
    </message>
    <message>
        <source>Show all of the picture (0)</source>
        <translation>Das ganze Bild zeigen (0)</translation>
    </message>
    <message>
        <source>Facade whose grid is corrected</source>
        <translation>Fassade, deren Raster berichtigt wird</translation>
    </message>
    <message>
        <source>Choose a photo in the strip below.</source>
        <translation>Wählen Sie unten im Streifen ein Foto.</translation>
    </message>
    <message>
        <source>Facade {0}</source>
        <translation>Fassade {0}</translation>
    </message>
    <message>
        <source>The photo is being decoded ...</source>
        <translation>Das Foto wird dekodiert ...</translation>
    </message>
    <message>
        <source>This photo cannot be shown.</source>
        <translation>Dieses Foto kann nicht gezeigt werden.</translation>
    </message>
</context>
<context>
    <name>PhotoStrip</name>
    <message>
        <source>Photos of the sortie</source>
        <translation>Fotos des Einsatzes</translation>
    </message>
    <message>
        <source>still to come</source>
        <translation>kommt noch</translation>
    </message>
    <message>
        <source>next</source>
        <translation>als Nächstes</translation>
    </message>
    <message>
        <source>taken</source>
        <translation>aufgenommen</translation>
    </message>
    <message>
        <source>taken, but not where it was planned</source>
        <translation>aufgenommen, aber nicht am geplanten Ort</translation>
    </message>
    <message>
        <source>passed without a photo</source>
        <translation>ohne Foto vorbeigeflogen</translation>
    </message>
    <message>
        <source>{0}: {1}</source>
        <translation>{0}: {1}</translation>
    </message>
    <message>
        <source>place off by {0}</source>
        <translation>Ort weicht ab um {0}</translation>
    </message>
    <message>
        <source>heading off by {0:.1f} deg</source>
        <translation>Richtung weicht ab um {0:.1f} Grad</translation>
    </message>
    <message>
        <source>pitch off by {0:.1f} deg</source>
        <translation>Neigung weicht ab um {0:.1f} Grad</translation>
    </message>
    <message>
        <source>new sections: {0}</source>
        <translation>neue Sektoren: {0}</translation>
    </message>
</context>
<context>
    <name>PhotosController</name>
    <message>
        <source>Make a coarse model</source>
        <translation>Grobmodell machen</translation>
    </message>
    <message>
        <source>The coarse model is made: {0} of {1} photos found their place, walls: {2}. It lies in {3}</source>
        <translation>Das Grobmodell ist fertig: {0} von {1} Fotos haben ihren Platz gefunden, Wände: {2}. Es liegt in {3}</translation>
    </message>
    <message>
        <source>Open or import a site first: photos are placed on it.</source>
        <translation>Öffnen oder importieren Sie zuerst einen Standort: darauf werden die Fotos eingeordnet.</translation>
    </message>
    <message>
        <source>Read photos</source>
        <translation>Fotos lesen</translation>
    </message>
    <message>
        <source>The data set is written, photos: {0}. Train a model of it on the Reconstruct tab: {1}</source>
        <translation>Der Datensatz ist geschrieben, Fotos: {0}. Im Reiter Rekonstruktion ein Modell daraus trainieren: {1}</translation>
    </message>
    <message>
        <source>Make the data set</source>
        <translation>Datensatz anlegen</translation>
    </message>
    <message>
        <source>Next battery</source>
        <translation>Nächster Akku</translation>
    </message>
    <message>
        <source>Next battery planned, photos: {0}; unseen views, expected: {1:.1f} dB to {2:.1f} dB</source>
        <translation>Nächster Akku geplant, Fotos: {0}; ungesehene Ansichten, erwartet: {1:.1f} dB auf {2:.1f} dB</translation>
    </message>
    <message>
        <source>Plan the next battery</source>
        <translation>Nächsten Akku planen</translation>
    </message>
    <message>
        <source>Count coverage</source>
        <translation>Abdeckung zählen</translation>
    </message>
    <message>
        <source>Find panels</source>
        <translation>Scheiben suchen</translation>
    </message>
    <message>
        <source>Measure the search</source>
        <translation>Suche messen</translation>
    </message>
    <message>
        <source>Use found panels</source>
        <translation>Gefundene Scheiben verwenden</translation>
    </message>
    <message>
        <source>Solve panels</source>
        <translation>Scheiben berechnen</translation>
    </message>
</context>
<context>
    <name>PhotosPage</name>
    <message>
        <source>Read photos</source>
        <translation>Fotos lesen</translation>
    </message>
    <message>
        <source>Choose folder ...</source>
        <translation>Ordner wählen ...</translation>
    </message>
    <message>
        <source>From photos alone ...</source>
        <translation>Nur aus Fotos ...</translation>
    </message>
    <message>
        <source>Find panels</source>
        <translation>Scheiben suchen</translation>
    </message>
    <message>
        <source>Use these panels</source>
        <translation>Diese Scheiben verwenden</translation>
    </message>
    <message>
        <source>Make data set ...</source>
        <translation>Datensatz anlegen ...</translation>
    </message>
    <message>
        <source>Plan the next battery</source>
        <translation>Nächsten Akku planen</translation>
    </message>
    <message>
        <source>Poses, sharpness, exposure and the coverage that was achieved</source>
        <translation>Lagen, Schärfe, Belichtung und die erreichte Abdeckung</translation>
    </message>
    <message>
        <source>Make a coarse model and a site of the photos of a first flight: poses, walls, roofs and ground</source>
        <translation>Aus den Fotos eines ersten Flugs ein Grobmodell und einen Standort machen: Posen, Wände, Dächer und Boden</translation>
    </message>
    <message>
        <source>Find the grid of every facade in the photos and put it into 3-D</source>
        <translation>Das Raster jeder Fassade in den Fotos suchen und in 3D bringen</translation>
    </message>
    <message>
        <source>Put these panels into the site in the place of its own; undo takes it back</source>
        <translation>Diese Scheiben anstelle der bisherigen in den Standort setzen; Rückgängig nimmt es zurück</translation>
    </message>
    <message>
        <source>Photos, poses and the site&apos;s panels together: what a model is trained on</source>
        <translation>Fotos, Posen und Scheiben des Standorts zusammen: woraus ein Modell lernt</translation>
    </message>
    <message>
        <source>Looks at what the panes mirror in these photos, and plans the flight that adds most to them</source>
        <translation>Betrachtet, was die Scheiben in diesen Fotos spiegeln, und plant den Flug, der am meisten hinzufügt</translation>
    </message>
    <message>
        <source>Panels</source>
        <translation>Scheiben</translation>
    </message>
    <message>
        <source>Coverage</source>
        <translation>Abdeckung</translation>
    </message>
    <message>
        <source>Accuracy</source>
        <translation>Genauigkeit</translation>
    </message>
    <message>
        <source>What accuracy costs in time</source>
        <translation>Was Genauigkeit an Zeit kostet</translation>
    </message>
    <message>
        <source>Photos of the first flight</source>
        <translation>Fotos des ersten Flugs</translation>
    </message>
    <message>
        <source>Folder for the coarse model</source>
        <translation>Ordner für das Grobmodell</translation>
    </message>
    <message>
        <source>Folder for the data set</source>
        <translation>Ordner für den Datensatz</translation>
    </message>
    <message>
        <source>Press a panel, or choose it with arrows; the space bar takes it out or puts it back.</source>
        <translation>Drücken Sie auf eine Scheibe oder wählen Sie sie mit den Pfeilen; die Leertaste nimmt sie heraus oder setzt sie ein.</translation>
    </message>
    <message>
        <source>Press a line, or choose it with Tab; arrows move it, Delete takes it out, Insert adds one.</source>
        <translation>Drücken Sie auf eine Linie oder wählen Sie sie mit Tab; Pfeile verschieben sie, Entf nimmt sie heraus, Einfg fügt eine hinzu.</translation>
    </message>
    <message>
        <source>Folder of photos</source>
        <translation>Ordner mit Fotos</translation>
    </message>
    <message>
        <source>Photo issues are listed here.</source>
        <translation>Hier stehen Mängel an Fotos.</translation>
    </message>
    <message>
        <source>Folder: {0}</source>
        <translation>Ordner: {0}</translation>
    </message>
    <message>
        <source>Open or import a site first: photos are placed on it.</source>
        <translation>Öffnen oder importieren Sie zuerst einen Standort: darauf werden die Fotos eingeordnet.</translation>
    </message>
    <message>
        <source>Read the photos of the flight.</source>
        <translation>Lesen Sie die Fotos des Flugs.</translation>
    </message>
    <message>
        <source>Find the panels in these photos.</source>
        <translation>Suchen Sie die Scheiben in diesen Fotos.</translation>
    </message>
    <message>
        <source>The corrected panels are being solved ...</source>
        <translation>Die berichtigten Scheiben werden berechnet ...</translation>
    </message>
    <message>
        <source>No grid was looked for in this photo; photos with one have the sign ▦.</source>
        <translation>In diesem Foto wurde kein Raster gesucht; Fotos mit einem haben das Zeichen ▦.</translation>
    </message>
</context>
<context>
    <name>PlaceMap</name>
    <message>
        <source>Where the photos were taken</source>
        <translation>Wo die Fotos aufgenommen wurden</translation>
    </message>
    <message>
        <source>N ↑</source>
        <translation>N ↑</translation>
    </message>
</context>
<context>
    <name>PlanController</name>
    <message>
        <source>{0}; release some, or ask for more views</source>
        <translation>{0}; einige freigeben oder mehr Aufnahmen verlangen</translation>
    </message>
    <message>
        <source>Plan</source>
        <translation>Planen</translation>
    </message>
    <message>
        <source>It was not looked at. Choose it in the list of plans to do so.</source>
        <translation>Er wurde nicht ausgewertet. Dazu in der Liste der Pläne auswählen.</translation>
    </message>
    <message>
        <source>Rename plan</source>
        <translation>Plan umbenennen</translation>
    </message>
    <message>
        <source>Only “Optimised (recommended)” can keep viewpoints. Choose it, or release those kept: {0}</source>
        <translation>Nur „Optimiert (empfohlen)“ kann Aufnahmepunkte behalten. Wählen Sie es, oder geben Sie die fixierten frei: {0}</translation>
    </message>
    <message>
        <source>Delete plan</source>
        <translation>Plan löschen</translation>
    </message>
    <message>
        <source>Open plan</source>
        <translation>Plan öffnen</translation>
    </message>
    <message>
        <source>Keep {0}</source>
        <translation>{0} fixieren</translation>
    </message>
    <message>
        <source>Release {0}</source>
        <translation>{0} freigeben</translation>
    </message>
    <message>
        <source>Turn {0}</source>
        <translation>{0} drehen</translation>
    </message>
    <message>
        <source>Move {0}</source>
        <translation>{0} verschieben</translation>
    </message>
    <message>
        <source>Add {0}</source>
        <translation>{0} hinzufügen</translation>
    </message>
    <message>
        <source>Delete {0}</source>
        <translation>{0} löschen</translation>
    </message>
    <message>
        <source>Aim {0}</source>
        <translation>{0} ausrichten</translation>
    </message>
    <message>
        <source>{0}: sections gained {1}, lost {2}; flight time {3:+.0f} s</source>
        <translation>{0}: Sektoren gewonnen {1}, verloren {2}; Flugzeit {3:+.0f} s</translation>
    </message>
    <message>
        <source>{0} stays as it is: switch off “Keep in the next plan” before you change it.</source>
        <translation>{0} bleibt, wie er ist: vor dem Ändern „Für Neuplanung fixieren“ ausschalten.</translation>
    </message>
    <message>
        <source>There is no plan to change; plan a flight or open a plan first.</source>
        <translation>Es gibt keinen Plan zum Ändern; zuerst einen Flug planen oder einen Plan öffnen.</translation>
    </message>
    <message>
        <source>The plan is still being looked at; try again in a moment.</source>
        <translation>Der Plan wird noch ausgewertet; gleich noch einmal versuchen.</translation>
    </message>
    <message>
        <source>The plan is not kept: it was made for “{0}”, which is no longer open.</source>
        <translation>Der Plan wird verworfen: Er gilt für „{0}“, das nicht mehr offen ist.</translation>
    </message>
    <message>
        <source>{0}, {1} views</source>
        <translation>{0}, Aufnahmen: {1}</translation>
    </message>
    <message>
        <source>Views: {0}, sorties: {1}; {2} of at most {3} directions of view seen</source>
        <translation>Aufnahmen: {0}, Einsätze: {1}; {2} von höchstens {3} Blickrichtungen gesehen</translation>
    </message>
    <message>
        <source>Look at the plan</source>
        <translation>Plan auswerten</translation>
    </message>
</context>
<context>
    <name>PlanForm</name>
    <message>
        <source>More settings</source>
        <translation>Mehr Einstellungen</translation>
    </message>
    <message>
        <source>number of views</source>
        <translation>Zahl der Aufnahmen</translation>
    </message>
    <message>
        <source>batteries at hand</source>
        <translation>Akkus</translation>
    </message>
    <message>
        <source>target coverage</source>
        <translation>Zielabdeckung</translation>
    </message>
    <message>
        <source>a model that is good enough</source>
        <translation>ein Modell, das gut genug ist</translation>
    </message>
    <message>
        <source>Limit the GSD</source>
        <translation>GSD begrenzen</translation>
    </message>
    <message>
        <source>any</source>
        <translation>beliebig</translation>
    </message>
    <message>
        <source>Plan for</source>
        <translation>Ziel</translation>
    </message>
    <message>
        <source>Coarsest GSD</source>
        <translation>Gröbste GSD</translation>
    </message>
    <message>
        <source>Pixels of {0} need views within {1}, but the safety distance is {2}: allow coarser pixels, or come nearer.</source>
        <translation>Pixel von {0} brauchen Aufnahmen aus höchstens {1}, der Mindestabstand ist aber {2}: gröbere Pixel zulassen oder näher heran.</translation>
    </message>
</context>
<context>
    <name>PlanLists</name>
    <message>
        <source>Viewpoints</source>
        <translation>Punkte</translation>
    </message>
    <message>
        <source>Not covered</source>
        <translation>Lücken</translation>
    </message>
    <message>
        <source>Clearance</source>
        <translation>Abstand</translation>
    </message>
    <message>
        <source>Plans</source>
        <translation>Pläne</translation>
    </message>
    <message>
        <source>Plan a flight, and what it does not cover stands here.</source>
        <translation>Einen Flug planen; dann steht hier, was er nicht abdeckt.</translation>
    </message>
    <message>
        <source>{0} sections could still be covered, {1} cannot be covered from anywhere allowed</source>
        <translation>{0} Sektoren wären noch erreichbar, {1} sind von keinem erlaubten Ort erreichbar</translation>
    </message>
    <message>
        <source>more views would cover them</source>
        <translation>mehr Aufnahmen würden sie abdecken</translation>
    </message>
    <message>
        <source>not known whether anything could</source>
        <translation>unbekannt, ob erreichbar</translation>
    </message>
    <message>
        <source>not known why</source>
        <translation>Grund unbekannt</translation>
    </message>
    <message>
        <source> and </source>
        <translation> und </translation>
    </message>
    <message>
        <source>the gimbal cannot look up so far</source>
        <translation>der Gimbal kann nicht so weit nach oben</translation>
    </message>
    <message>
        <source>the gimbal cannot look down so far</source>
        <translation>der Gimbal kann nicht so weit nach unten</translation>
    </message>
    <message>
        <source>below the lowest flight allowed</source>
        <translation>unter der niedrigsten erlaubten Flughöhe</translation>
    </message>
    <message>
        <source>above the airspace</source>
        <translation>über dem Luftraum</translation>
    </message>
    <message>
        <source>beyond the sides of the airspace</source>
        <translation>seitlich außerhalb des Luftraums</translation>
    </message>
    <message>
        <source>too far away for the GSD wanted</source>
        <translation>zu weit weg für die gewünschte GSD</translation>
    </message>
    <message>
        <source>too close to building or obstacle</source>
        <translation>zu nah an Gebäude oder Hindernis</translation>
    </message>
    <message>
        <source>in a no-fly volume</source>
        <translation>in einer Flugverbotszone</translation>
    </message>
    <message>
        <source>below the ground</source>
        <translation>unter dem Boden</translation>
    </message>
    <message>
        <source>hidden by something</source>
        <translation>verdeckt</translation>
    </message>
    <message>
        <source>cannot be flown to</source>
        <translation>nicht anfliegbar</translation>
    </message>
    <message>
        <source>Measure clearance</source>
        <translation>Abstand messen</translation>
    </message>
    <message>
        <source>Open plan</source>
        <translation>Plan öffnen</translation>
    </message>
    <message>
        <source>Plans (*.json)</source>
        <translation>Pläne (*.json)</translation>
    </message>
    <message>
        <source>Select two or more plans in the list of plans to compare.</source>
        <translation>Zum Vergleichen zwei oder mehr Pläne in der Liste auswählen.</translation>
    </message>
</context>
<context>
    <name>PlanPage</name>
    <message>
        <source>Minutes in the air</source>
        <translation>Minuten in der Luft</translation>
    </message>
    <message>
        <source>Expected PSNR [dB]</source>
        <translation>Erwartetes PSNR [dB]</translation>
    </message>
    <message>
        <source>What this plan is worth is not known, or it was changed since; plan it again.</source>
        <translation>Was dieser Plan wert ist, ist nicht bekannt, oder er wurde seitdem geändert; neu planen.</translation>
    </message>
    <message>
        <source>Sun</source>
        <translation>Sonne</translation>
    </message>
    <message>
        <source>Plan</source>
        <translation>Planen</translation>
    </message>
    <message>
        <source>Plan the flight</source>
        <translation>Den Flug planen</translation>
    </message>
    <message>
        <source>Stop and keep</source>
        <translation>Stopp, behalten</translation>
    </message>
    <message>
        <source>Compare plans</source>
        <translation>Pläne vergleichen</translation>
    </message>
    <message>
        <source>Quality</source>
        <translation>Güte</translation>
    </message>
    <message>
        <source>Worth</source>
        <translation>Wert</translation>
    </message>
    <message>
        <source>Effects</source>
        <translation>Effekte</translation>
    </message>
    <message>
        <source>Panel</source>
        <translation>Scheibe</translation>
    </message>
    <message>
        <source>View</source>
        <translation>Punkt</translation>
    </message>
    <message>
        <source>Open or import a site first, on the Site tab.</source>
        <translation>Zuerst im Reiter Standort einen Standort öffnen oder importieren.</translation>
    </message>
    <message>
        <source>No panels yet: find them in photos (Photos tab), or draw them on the building (Site tab).</source>
        <translation>Noch keine Scheiben: in Fotos suchen (Reiter Fotos) oder auf das Gebäude zeichnen (Reiter Standort).</translation>
    </message>
    <message>
        <source>Planning ...</source>
        <translation>Planung läuft ...</translation>
    </message>
    <message>
        <source>No plan yet.</source>
        <translation>Noch kein Plan.</translation>
    </message>
    <message>
        <source>This plan cannot be judged. {0}</source>
        <translation>Dieser Plan lässt sich nicht beurteilen. {0}</translation>
    </message>
    <message>
        <source>The plan is being looked at ...</source>
        <translation>Der Plan wird ausgewertet ...</translation>
    </message>
    <message>
        <source>Ready to fly; warnings: {0}</source>
        <translation>Flugbereit; Warnungen: {0}</translation>
    </message>
    <message>
        <source>NOT ready to fly; errors: {0}. {1}</source>
        <translation>NICHT flugbereit; Fehler: {0}. {1}</translation>
    </message>
    <message>
        <source>Views: {0}, sorties: {1}</source>
        <translation>Aufnahmen: {0}, Einsätze: {1}</translation>
    </message>
    <message>
        <source>{0} of {1} sections covered ({2:.1f} % of the {3} that any flight could cover)</source>
        <translation>{0} von {1} Sektoren abgedeckt ({2:.1f} % der {3} überhaupt erreichbaren)</translation>
    </message>
    <message>
        <source>Time in the air {0}, distance {1}</source>
        <translation>Flugzeit {0}, Strecke {1}</translation>
    </message>
    <message>
        <source>GSD from {0}</source>
        <translation>GSD ab {0}</translation>
    </message>
    <message>
        <source>Aircraft at once: {0}, all landed after {1}</source>
        <translation>Fluggeräte zugleich: {0}, alle gelandet nach {1}</translation>
    </message>
    <message>
        <source>smallest clearance {0}</source>
        <translation>kleinster Abstand {0}</translation>
    </message>
    <message>
        <source>Unseen views of its model: {0}</source>
        <translation>Neue Ansichten seines Modells: {0}</translation>
    </message>
    <message>
        <source>this plan, battery by battery</source>
        <translation>dieser Plan, Akku für Akku</translation>
    </message>
    <message>
        <source>one battery more</source>
        <translation>ein Akku mehr</translation>
    </message>
    <message>
        <source>{0:.1f} dB better</source>
        <translation>{0:.1f} dB besser</translation>
    </message>
    <message>
        <source>{0:.1f} dB worse</source>
        <translation>{0:.1f} dB schlechter</translation>
    </message>
</context>
<context>
    <name>PlanPictures</name>
    <message>
        <source>Covered of what is possible</source>
        <translation>Abgedeckt vom Erreichbaren</translation>
    </message>
    <message>
        <source>Finest pixel</source>
        <translation>Feinstes Pixel</translation>
    </message>
    <message>
        <source>Clearance</source>
        <translation>Abstand</translation>
    </message>
</context>
<context>
    <name>PlanPlayer</name>
    <message>
        <source>Fly</source>
        <translation>Fliegen</translation>
    </message>
    <message>
        <source>Let the aircraft fly the plan in the view</source>
        <translation>Das Fluggerät den Plan in der Ansicht fliegen lassen</translation>
    </message>
    <message>
        <source>Time in the flight</source>
        <translation>Zeit im Flug</translation>
    </message>
    <message>
        <source>Time in the flight, over all sorties</source>
        <translation>Zeit im Flug, über alle Einsätze</translation>
    </message>
    <message>
        <source>How much faster than the flight</source>
        <translation>Wievielmal schneller als der Flug</translation>
    </message>
    <message>
        <source>Show the plan without the aircraft</source>
        <translation>Den Plan ohne das Fluggerät zeigen</translation>
    </message>
    <message>
        <source>Sortie {0}: {1} of {2}, photo {3}</source>
        <translation>Einsatz {0}: {1} von {2}, Foto {3}</translation>
    </message>
    <message>
        <source>Pause</source>
        <translation>Pause</translation>
    </message>
</context>
<context>
    <name>PlansList</name>
    <message>
        <source>Plans</source>
        <translation>Pläne</translation>
    </message>
    <message>
        <source>Make current</source>
        <translation>Verwenden</translation>
    </message>
    <message>
        <source>Look at this plan, edit, export and fly it; a double click does so too</source>
        <translation>Diesen Plan ansehen, bearbeiten, exportieren und fliegen; ein Doppelklick tut dasselbe</translation>
    </message>
    <message>
        <source>Compare</source>
        <translation>Vergleichen</translation>
    </message>
    <message>
        <source>Show the selected plans side by side (two or more)</source>
        <translation>Ausgewählte Pläne nebeneinander zeigen (zwei oder mehr)</translation>
    </message>
    <message>
        <source>Rename ...</source>
        <translation>Umbenennen ...</translation>
    </message>
    <message>
        <source>Delete</source>
        <translation>Löschen</translation>
    </message>
    <message>
        <source>Open plan ...</source>
        <translation>Plan öffnen ...</translation>
    </message>
    <message>
        <source>Plan</source>
        <translation>Plan</translation>
    </message>
    <message>
        <source>Method</source>
        <translation>Verfahren</translation>
    </message>
    <message>
        <source>Views</source>
        <translation>Aufnahmen</translation>
    </message>
    <message>
        <source>Covered</source>
        <translation>Abgedeckt</translation>
    </message>
    <message>
        <source>of at most</source>
        <translation>von höchstens</translation>
    </message>
    <message>
        <source>Sorties</source>
        <translation>Einsätze</translation>
    </message>
    <message>
        <source>Duration</source>
        <translation>Dauer</translation>
    </message>
    <message>
        <source>Length</source>
        <translation>Flugweg</translation>
    </message>
    <message>
        <source>Rename plan</source>
        <translation>Plan umbenennen</translation>
    </message>
    <message>
        <source>Name</source>
        <translation>Name</translation>
    </message>
</context>
<context>
    <name>PolygonBox</name>
    <message>
        <source>Add a corner after this one</source>
        <translation>Ecke nach dieser hinzufügen</translation>
    </message>
    <message>
        <source>Delete this corner</source>
        <translation>Diese Ecke löschen</translation>
    </message>
</context>
<context>
    <name>PoseBox</name>
    <message>
        <source>Refine poses</source>
        <translation>Posen verfeinern</translation>
    </message>
    <message>
        <source>Own poses</source>
        <translation>Eigene Posen</translation>
    </message>
    <message>
        <source>Match the photos with each other and adjust all rays; computed once and kept beside the photos</source>
        <translation>Die Fotos einander zuordnen und alle Strahlen ausgleichen; wird einmal berechnet und neben den Fotos aufbewahrt</translation>
    </message>
    <message>
        <source>Go back to the poses that the photos themselves have</source>
        <translation>Zurück zu den Posen, die die Fotos selbst haben</translation>
    </message>
    <message>
        <source>By how much poses differ from the photos&apos; own, and how well the photos fit each other; more below</source>
        <translation>Wie weit Posen von den eigenen der Fotos abweichen und wie gut die Fotos zueinander passen; mehr steht darunter</translation>
    </message>
    <message>
        <source>Refined: {0} of {1} photos.</source>
        <translation>Verfeinert: {0} von {1} Fotos.</translation>
    </message>
    <message>
        <source>Moved {0}, at most {1}; turned {2:.2f}°, at most {3:.2f}°; {4:.2f} px.</source>
        <translation>Verschoben um {0}, höchstens {1}; gedreht um {2:.2f}°, höchstens {3:.2f}°; {4:.2f} px.</translation>
    </message>
    <message>
        <source>{0} found no place.</source>
        <translation>{0} fanden keinen Platz.</translation>
    </message>
</context>
<context>
    <name>PreflightList</name>
    <message>
        <source>{0}: {1}</source>
        <translation>{0}: {1}</translation>
    </message>
    <message>
        <source>Set parameters ...</source>
        <translation>Parameter setzen ...</translation>
    </message>
    <message>
        <source>Fly from this height ...</source>
        <translation>Von dieser Höhe fliegen ...</translation>
    </message>
    <message>
        <source>Home here ...</source>
        <translation>Startplatz hier ...</translation>
    </message>
    <message>
        <source>Overrule ...</source>
        <translation>Übergehen ...</translation>
    </message>
    <message>
        <source>Link</source>
        <translation>Verbindung</translation>
    </message>
    <message>
        <source>Position</source>
        <translation>Position</translation>
    </message>
    <message>
        <source>GNSS</source>
        <translation>GNSS</translation>
    </message>
    <message>
        <source>Home</source>
        <translation>Startplatz</translation>
    </message>
    <message>
        <source>Height of home</source>
        <translation>Höhe des Startplatzes</translation>
    </message>
    <message>
        <source>Battery</source>
        <translation>Akku</translation>
    </message>
    <message>
        <source>Sensors</source>
        <translation>Sensoren</translation>
    </message>
    <message>
        <source>Remote ID</source>
        <translation>Remote ID</translation>
    </message>
    <message>
        <source>RTK corrections</source>
        <translation>RTK-Korrekturen</translation>
    </message>
    <message>
        <source>Wind</source>
        <translation>Wind</translation>
    </message>
    <message>
        <source>Lowest flight</source>
        <translation>Tiefster Flug</translation>
    </message>
    <message>
        <source>Mission on board</source>
        <translation>Mission an Bord</translation>
    </message>
    <message>
        <source>Geofence on board</source>
        <translation>Geofence an Bord</translation>
    </message>
    <message>
        <source>Rally points on board</source>
        <translation>Rally-Punkte an Bord</translation>
    </message>
    <message>
        <source>Parameters</source>
        <translation>Parameter</translation>
    </message>
    <message>
        <source>Signal lost</source>
        <translation>Signal verloren</translation>
    </message>
    <message>
        <source>Return to home (RTH)</source>
        <translation>Rückkehr (RTH)</translation>
    </message>
    <message>
        <source>Remote control lost</source>
        <translation>Fernsteuerung verloren</translation>
    </message>
    <message>
        <source>Battery low</source>
        <translation>Akku schwach</translation>
    </message>
    <message>
        <source>Position lost</source>
        <translation>Position verloren</translation>
    </message>
    <message>
        <source>At the geofence</source>
        <translation>Am Geofence</translation>
    </message>
    <message>
        <source>Height limit</source>
        <translation>Höhengrenze</translation>
    </message>
    <message>
        <source>Circle around home</source>
        <translation>Kreis um den Startplatz</translation>
    </message>
</context>
<context>
    <name>ProfileChart</name>
    <message>
        <source>over time</source>
        <translation>über der Zeit</translation>
    </message>
    <message>
        <source>over distance</source>
        <translation>über dem Flugweg</translation>
    </message>
    <message>
        <source>Height and speed</source>
        <translation>Höhe und Geschwindigkeit</translation>
    </message>
    <message>
        <source>Sortie {0}</source>
        <translation>Einsatz {0}</translation>
    </message>
    <message>
        <source>Height [{0}]</source>
        <translation>Höhe [{0}]</translation>
    </message>
    <message>
        <source>Speed [{0}]</source>
        <translation>Tempo [{0}]</translation>
    </message>
    <message>
        <source>Time [min]</source>
        <translation>Zeit [min]</translation>
    </message>
    <message>
        <source>Distance [{0}]</source>
        <translation>Flugweg [{0}]</translation>
    </message>
    <message>
        <source>Time [min]; take-off and landing add {0:.0f} s</source>
        <translation>Zeit [min]; Start und Landung kommen mit {0:.0f} s dazu</translation>
    </message>
    <message>
        <source>No sortie to show: plan a flight first.</source>
        <translation>Kein Einsatz zu zeigen: zuerst einen Flug planen.</translation>
    </message>
    <message>
        <source>terrain</source>
        <translation>Gelände</translation>
    </message>
    <message>
        <source>ground</source>
        <translation>Boden</translation>
    </message>
    <message>
        <source>airspace floor</source>
        <translation>Luftraum unten</translation>
    </message>
    <message>
        <source>airspace ceiling</source>
        <translation>Luftraum oben</translation>
    </message>
    <message>
        <source>{0} min, {1} flown: {2} above take-off, {5} above the terrain, {3}, nearest photo {4}</source>
        <translation>{0} min, {1} geflogen: {2} über dem Start, {5} über dem Gelände, {3}, nächstes Foto {4}</translation>
    </message>
    <message>
        <source>legal ceiling</source>
        <translation>gesetzliche Höhengrenze</translation>
    </message>
    <message>
        <source>{0} {1}</source>
        <translation>{0} {1}</translation>
    </message>
    <message>
        <source>{0} min, {1} flown: {2} above take-off, {3}, nearest photo {4}</source>
        <translation>{0} min, {1} geflogen: {2} über Start, {3}, nächstes Foto {4}</translation>
    </message>
</context>
<context>
    <name>ProgressPage</name>
    <message>
        <source>Appears here while a model learns.</source>
        <translation>Erscheint hier, während ein Modell lernt.</translation>
    </message>
    <message>
        <source>time in s</source>
        <translation>Zeit in s</translation>
    </message>
    <message>
        <source>PSNR in dB</source>
        <translation>PSNR in dB</translation>
    </message>
    <message>
        <source>loss</source>
        <translation>Verlust</translation>
    </message>
    <message>
        <source>Facades of some unseen views</source>
        <translation>Fassaden einiger neuer Ansichten</translation>
    </message>
    <message>
        <source>Terms of the loss</source>
        <translation>Teile des Verlusts</translation>
    </message>
    <message>
        <source>Nothing is being trained.</source>
        <translation>Es wird nichts trainiert.</translation>
    </message>
    <message>
        <source>time in min</source>
        <translation>Zeit in min</translation>
    </message>
    <message>
        <source>unseen views</source>
        <translation>ungesehene Aufnahmen</translation>
    </message>
</context>
<context>
    <name>ProjectController</name>
    <message>
        <source>Something is running: the language changes when Reflight is started next.</source>
        <translation>Etwas läuft noch: Die Sprache wechselt beim nächsten Start von Reflight.</translation>
    </message>
    <message>
        <source>New project</source>
        <translation>Neues Projekt</translation>
    </message>
    <message>
        <source>Map tiles</source>
        <translation>Kartenkacheln</translation>
    </message>
    <message>
        <source>Sample project</source>
        <translation>Beispielprojekt</translation>
    </message>
    <message>
        <source>Map tiles (*.mbtiles *.pmtiles)</source>
        <translation>Kartenkacheln (*.mbtiles *.pmtiles)</translation>
    </message>
    <message>
        <source>The settings could not be kept: {0}</source>
        <translation>Die Einstellungen ließen sich nicht sichern: {0}</translation>
    </message>
    <message>
        <source>Open project</source>
        <translation>Projekt öffnen</translation>
    </message>
    <message>
        <source>{0}: this folder is not there any more; was it moved or renamed?</source>
        <translation>{0}: Dieser Ordner ist nicht mehr da; wurde er verschoben oder umbenannt?</translation>
    </message>
    <message>
        <source>Save project as</source>
        <translation>Projekt speichern unter</translation>
    </message>
    <message>
        <source>Saved in {0}</source>
        <translation>Gespeichert in {0}</translation>
    </message>
    <message>
        <source>Save</source>
        <translation>Speichern</translation>
    </message>
    <message>
        <source>{0}: {1} panels, {2} plans</source>
        <translation>{0}: Scheiben {1}, Pläne {2}</translation>
    </message>
    <message>
        <source>Look at the project</source>
        <translation>Projekt ansehen</translation>
    </message>
    <message>
        <source>Your work is back. It is not saved yet: Project &gt; Save keeps it.</source>
        <translation>Ihre Arbeit ist wieder da. Gespeichert ist sie noch nicht: Projekt &gt; Speichern behält sie.</translation>
    </message>
</context>
<context>
    <name>QShortcut</name>
    <message>
        <source>Return</source>
        <translation>Eingabe</translation>
    </message>
    <message>
        <source>Enter</source>
        <translation>Eingabe</translation>
    </message>
</context>
<context>
    <name>QualityChart</name>
    <message>
        <source>Keep the best views found so far and plan the route</source>
        <translation>Die besten bisher gefundenen Aufnahmen behalten und die Route planen</translation>
    </message>
    <message>
        <source>covered sections</source>
        <translation>abgedeckte Sektoren</translation>
    </message>
    <message>
        <source>time in s</source>
        <translation>Zeit in s</translation>
    </message>
    <message>
        <source>Stop and keep</source>
        <translation>Stopp, behalten</translation>
    </message>
    <message>
        <source>Quality against time appears here while a plan runs.</source>
        <translation>Während der Planung erscheint hier Güte über der Zeit.</translation>
    </message>
    <message>
        <source>The search found {0:.0f} sections, {1:.1f} % of the {2:.0f} that any flight could cover</source>
        <translation>Die Suche fand {0:.0f} Sektoren, {1:.1f} % der {2:.0f} überhaupt erreichbaren</translation>
    </message>
    <message>
        <source>{0:.0f} sections covered, {1:.1f} % of the {2:.0f} that any flight could cover</source>
        <translation>{0:.0f} Sektoren abgedeckt, {1:.1f} % der {2:.0f} überhaupt erreichbaren</translation>
    </message>
    <message>
        <source>{0:.0f} sections covered</source>
        <translation>{0:.0f} Sektoren abgedeckt</translation>
    </message>
    <message>
        <source>at most {0:.0f} s left</source>
        <translation>höchstens noch {0:.0f} s</translation>
    </message>
</context>
<context>
    <name>Questions</name>
    <message>
        <source>{0} is there already. Replace it?</source>
        <translation>{0} gibt es schon. Ersetzen?</translation>
    </message>
    <message>
        <source>Unsaved changes</source>
        <translation>Ungesicherte Änderungen</translation>
    </message>
    <message>
        <source>This project has changes that are not saved. Save them first?</source>
        <translation>Dieses Projekt hat ungesicherte Änderungen. Zuerst speichern?</translation>
    </message>
    <message>
        <source>Nothing is lost: Reflight ended before this work was saved, and kept a copy of it at {0}. In the copy, and not in what was saved:
{1}

Go on with it? What was saved stays as it is until you save again.</source>
        <translation>Nichts ist verloren: Reflight endete, bevor diese Arbeit gespeichert war, und hat um {0} eine Kopie behalten. In der Kopie, aber nicht im Gespeicherten:
{1}

Damit weiterarbeiten? Das Gespeicherte bleibt, wie es ist, bis Sie wieder speichern.</translation>
    </message>
    <message>
        <source>Nothing is lost: Reflight ended before this work was saved, and kept a copy of it at {0}. All of it is in the copy: it was never saved as a project.

Go on with it?</source>
        <translation>Nichts ist verloren: Reflight endete, bevor diese Arbeit gespeichert war, und hat um {0} eine Kopie behalten. Alles ist in der Kopie: Es wurde nie als Projekt gespeichert.

Damit weiterarbeiten?</translation>
    </message>
    <message>
        <source>The project was saved by others since then: what they changed is not in the copy.</source>
        <translation>Das Projekt wurde seitdem von anderen gespeichert: was sie geändert haben, ist nicht in der Kopie.</translation>
    </message>
    <message>
        <source>Restore?</source>
        <translation>Wiederherstellen?</translation>
    </message>
    <message>
        <source>Restore</source>
        <translation>Wiederherstellen</translation>
    </message>
    <message>
        <source>Delete the copy</source>
        <translation>Kopie löschen</translation>
    </message>
    <message>
        <source>Decide later</source>
        <translation>Später entscheiden</translation>
    </message>
    <message>
        <source>New folder:</source>
        <translation>Neuer Ordner:</translation>
    </message>
    <message>
        <source>{0}: there is nothing of that name.</source>
        <translation>{0}: das gibt es nicht.</translation>
    </message>
</context>
<context>
    <name>RallyPage</name>
    <message>
        <source>Rally point</source>
        <translation>Rally-Punkt</translation>
    </message>
    <message>
        <source>Put it on the ground</source>
        <translation>Auf den Boden setzen</translation>
    </message>
    <message>
        <source>Place</source>
        <translation>Ort</translation>
    </message>
    <message>
        <source>An aircraft that returns lands at the nearest of home and the rally points.</source>
        <translation>Ein Fluggerät, das zurückkehrt, landet am nächsten von Startplatz und Rally-Punkten.</translation>
    </message>
    <message>
        <source>Change {0}</source>
        <translation>{0} ändern</translation>
    </message>
</context>
<context>
    <name>ReachTable</name>
    <message>
        <source>Why not</source>
        <translation>Warum nicht</translation>
    </message>
    <message>
        <source>Sections</source>
        <translation>Sektoren</translation>
    </message>
    <message>
        <source>Panels</source>
        <translation>Scheiben</translation>
    </message>
    <message>
        <source>What lacks least</source>
        <translation>Am wenigsten fehlt</translation>
    </message>
    <message>
        <source>Sections that are not covered</source>
        <translation>Nicht abgedeckte Sektoren</translation>
    </message>
</context>
<context>
    <name>ReadoutsView</name>
    <message>
        <source>above take-off</source>
        <translation>über Start</translation>
    </message>
    <message>
        <source>speed</source>
        <translation>Tempo</translation>
    </message>
    <message>
        <source>facade</source>
        <translation>Fassade</translation>
    </message>
    <message>
        <source>photos</source>
        <translation>Fotos</translation>
    </message>
    <message>
        <source>battery</source>
        <translation>Akku</translation>
    </message>
    <message>
        <source>to reserve</source>
        <translation>bis Reserve</translation>
    </message>
    <message>
        <source>wind</source>
        <translation>Wind</translation>
    </message>
    <message>
        <source>GNSS</source>
        <translation>GNSS</translation>
    </message>
    <message>
        <source>{0} missing</source>
        <translation>{0} fehlen</translation>
    </message>
    <message>
        <source>min {0}</source>
        <translation>min {0}</translation>
    </message>
    <message>
        <source>from {0:.0f}°</source>
        <translation>aus {0:.0f}°</translation>
    </message>
    <message>
        <source>{0} sat</source>
        <translation>{0} Sat</translation>
    </message>
    <message>
        <source>coverage: no photo yet</source>
        <translation>Abdeckung: noch kein Foto</translation>
    </message>
    <message>
        <source>coverage {0:.1f} % of planned ({1} of {2})</source>
        <translation>Abdeckung {0:.1f} % vom Geplanten ({1} von {2})</translation>
    </message>
</context>
<context>
    <name>ReconstructController</name>
    <message>
        <source>The training was cancelled; resume it whenever you like.</source>
        <translation>Das Training wurde abgebrochen; es kann jederzeit fortgesetzt werden.</translation>
    </message>
    <message>
        <source>The training was cancelled before there was anything to keep.</source>
        <translation>Das Training wurde abgebrochen, bevor es etwas zu behalten gab.</translation>
    </message>
    <message>
        <source>The model is written: {0}</source>
        <translation>Das Modell ist geschrieben: {0}</translation>
    </message>
    <message>
        <source>Training: {0} steps</source>
        <translation>Training: {0} Schritte</translation>
    </message>
    <message>
        <source>Training: {0}</source>
        <translation>Training: {0}</translation>
    </message>
    <message>
        <source>the system ended it, mostly because memory ran out</source>
        <translation>das System hat ihn beendet, meist weil der Speicher ausging</translation>
    </message>
    <message>
        <source>exit status {0}</source>
        <translation>Endestatus {0}</translation>
    </message>
    <message>
        <source>Close other programs, and go on from the last state.</source>
        <translation>Schließen Sie andere Programme, und setzen Sie beim letzten Stand fort.</translation>
    </message>
    <message>
        <source>Close other programs, or ask for less, and try again.</source>
        <translation>Schließen Sie andere Programme, oder verlangen Sie weniger, und versuchen Sie es noch einmal.</translation>
    </message>
    <message>
        <source>The process that trains has ended ({0}). {1}</source>
        <translation>Der Prozess, der trainiert, ist zu Ende ({0}). {1}</translation>
    </message>
    <message>
        <source>Training: Reflight failed where it should not ({0}: {1}); please report it</source>
        <translation>Training: Reflight ist gescheitert, wo es nicht sollte ({0}: {1}); bitte melden Sie es</translation>
    </message>
</context>
<context>
    <name>ReconstructPage</name>
    <message>
        <source>Computer</source>
        <translation>Rechner</translation>
    </message>
    <message>
        <source>Progress</source>
        <translation>Verlauf</translation>
    </message>
    <message>
        <source>Effects</source>
        <translation>Effekte</translation>
    </message>
    <message>
        <source>What this computer has, and what follows</source>
        <translation>Was dieser Rechner hat, und was daraus folgt</translation>
    </message>
    <message>
        <source>Which model of mirrored light the scene calls for, and why</source>
        <translation>Welches Modell des Spiegellichts die Szene verlangt, und warum</translation>
    </message>
    <message>
        <source>Folder of a data set</source>
        <translation>Ordner eines Datensatzes</translation>
    </message>
    <message>
        <source>Folder for the model</source>
        <translation>Ordner für das Modell</translation>
    </message>
    <message>
        <source>model</source>
        <translation>Modell</translation>
    </message>
    <message>
        <source>starting</source>
        <translation>Start</translation>
    </message>
    <message>
        <source>{0}, {1} steps, {2} splats</source>
        <translation>{0}, {1} Schritte, {2} Splats</translation>
    </message>
    <message>
        <source>; {0:.2f} dB on facades of {1} unseen views</source>
        <translation>; {0:.2f} dB auf Fassaden von {1} neuen Ansichten</translation>
    </message>
    <message>
        <source>; {0:.2f} dB on facades of some unseen views</source>
        <translation>; {0:.2f} dB auf Fassaden einiger neuer Ansichten</translation>
    </message>
    <message>
        <source>Breaking off; the state is being kept ...</source>
        <translation>Abbruch; der Stand wird gesichert ...</translation>
    </message>
    <message>
        <source>Stops as soon as there is a model: {0}</source>
        <translation>Hört auf, sobald es ein Modell gibt: {0}</translation>
    </message>
    <message>
        <source>Stopped: the rates fall, then the model is written.</source>
        <translation>Aufgehört: die Lernraten fallen, dann wird das Modell geschrieben.</translation>
    </message>
    <message>
        <source>Paused. The model can be looked at.</source>
        <translation>Angehalten. Das Modell kann angesehen werden.</translation>
    </message>
    <message>
        <source>The model is finished.</source>
        <translation>Das Modell ist fertig.</translation>
    </message>
    <message>
        <source>Cancelled; the state is kept.</source>
        <translation>Abgebrochen; der Stand ist gesichert.</translation>
    </message>
    <message>
        <source>The training has failed; the message says why.</source>
        <translation>Das Training ist gescheitert; die Meldung sagt, warum.</translation>
    </message>
</context>
<context>
    <name>ReconstructQuestions</name>
    <message>
        <source>A model is being trained</source>
        <translation>Ein Modell wird trainiert</translation>
    </message>
    <message>
        <source>Closing the window breaks the training off. What it has reached is kept, and the Reconstruct tab goes on with it later. Close the window?</source>
        <translation>Das Fenster zu schließen bricht das Training ab. Was es erreicht hat, bleibt erhalten, und der Reiter Rekonstruktion setzt es später fort. Fenster schließen?</translation>
    </message>
</context>
<context>
    <name>RecordDialog</name>
    <message>
        <source>Choose ...</source>
        <translation>Wählen ...</translation>
    </message>
    <message>
        <source>picture</source>
        <translation>Bild</translation>
    </message>
    <message>
        <source>or a file</source>
        <translation>oder eine Datei</translation>
    </message>
    <message>
        <source>Pictures (*.png *.jpg *.jpeg *.webp)</source>
        <translation>Bilder (*.png *.jpg *.jpeg *.webp)</translation>
    </message>
    <message>
        <source>Files (*)</source>
        <translation>Dateien (*)</translation>
    </message>
</context>
<context>
    <name>RecordSide</name>
    <message>
        <source>Properties</source>
        <translation>Eigenschaften</translation>
    </message>
    <message>
        <source>Inspections</source>
        <translation>Prüfungen</translation>
    </message>
    <message>
        <source>Defects</source>
        <translation>Schäden</translation>
    </message>
    <message>
        <source>Maintenance</source>
        <translation>Wartung</translation>
    </message>
    <message>
        <source>Documents</source>
        <translation>Dokumente</translation>
    </message>
    <message>
        <source>Add ...</source>
        <translation>Neu ...</translation>
    </message>
    <message>
        <source>Change ...</source>
        <translation>Ändern ...</translation>
    </message>
    <message>
        <source>Undo</source>
        <translation>Rückgängig</translation>
    </message>
    <message>
        <source>Delete</source>
        <translation>Löschen</translation>
    </message>
    <message>
        <source>Report as PDF ...</source>
        <translation>Bericht als PDF ...</translation>
    </message>
    <message>
        <source>No panel is chosen. Click one in the picture, or in the list.</source>
        <translation>Keine Scheibe gewählt. Im Bild oder in der Liste eine anklicken.</translation>
    </message>
    <message>
        <source>{0} x {1}, {2}</source>
        <translation>{0} x {1}, {2}</translation>
    </message>
    <message>
        <source>Records</source>
        <translation>Einträge</translation>
    </message>
    <message>
        <source>the panel</source>
        <translation>der Scheibe</translation>
    </message>
    <message>
        <source>its facade</source>
        <translation>ihrer Fassade</translation>
    </message>
    <message>
        <source>the building</source>
        <translation>dem Gebäude</translation>
    </message>
    <message>
        <source>Records of</source>
        <translation>Einträge zu</translation>
    </message>
    <message>
        <source>Facade</source>
        <translation>Fassade</translation>
    </message>
    <message>
        <source>Size</source>
        <translation>Größe</translation>
    </message>
    <message>
        <source>GlobalId</source>
        <translation>GlobalId</translation>
    </message>
    <message>
        <source>Take the last change of records back</source>
        <translation>Die letzte Änderung der Einträge zurücknehmen</translation>
    </message>
</context>
<context>
    <name>Records</name>
    <message>
        <source>2026-03-31</source>
        <translation>2026-03-31</translation>
    </message>
    <message>
        <source>Property</source>
        <translation>Eigenschaft</translation>
    </message>
    <message>
        <source>Inspection</source>
        <translation>Prüfung</translation>
    </message>
    <message>
        <source>Defect</source>
        <translation>Schaden</translation>
    </message>
    <message>
        <source>Maintenance</source>
        <translation>Wartung</translation>
    </message>
    <message>
        <source>Document</source>
        <translation>Dokument</translation>
    </message>
    <message>
        <source>name</source>
        <translation>Name</translation>
    </message>
    <message>
        <source>value</source>
        <translation>Wert</translation>
    </message>
    <message>
        <source>type</source>
        <translation>Art des Wertes</translation>
    </message>
    <message>
        <source>unit</source>
        <translation>Einheit</translation>
    </message>
    <message>
        <source>date</source>
        <translation>Datum</translation>
    </message>
    <message>
        <source>inspector</source>
        <translation>Prüfer</translation>
    </message>
    <message>
        <source>method</source>
        <translation>Verfahren</translation>
    </message>
    <message>
        <source>result</source>
        <translation>Ergebnis</translation>
    </message>
    <message>
        <source>note</source>
        <translation>Hinweis</translation>
    </message>
    <message>
        <source>kind</source>
        <translation>Art</translation>
    </message>
    <message>
        <source>severity</source>
        <translation>Schwere</translation>
    </message>
    <message>
        <source>found on</source>
        <translation>gefunden am</translation>
    </message>
    <message>
        <source>from the left, 0 to 1</source>
        <translation>von links, 0 bis 1</translation>
    </message>
    <message>
        <source>from below, 0 to 1</source>
        <translation>von unten, 0 bis 1</translation>
    </message>
    <message>
        <source>state</source>
        <translation>Zustand</translation>
    </message>
    <message>
        <source>repaired on</source>
        <translation>behoben am</translation>
    </message>
    <message>
        <source>work</source>
        <translation>Arbeit</translation>
    </message>
    <message>
        <source>done by</source>
        <translation>ausgeführt von</translation>
    </message>
    <message>
        <source>cost</source>
        <translation>Kosten</translation>
    </message>
    <message>
        <source>currency</source>
        <translation>Währung</translation>
    </message>
    <message>
        <source>next due</source>
        <translation>wieder fällig</translation>
    </message>
    <message>
        <source>title</source>
        <translation>Titel</translation>
    </message>
    <message>
        <source>address or file</source>
        <translation>Adresse oder Datei</translation>
    </message>
    <message>
        <source>material</source>
        <translation>Werkstoff</translation>
    </message>
    <message>
        <source>maker</source>
        <translation>Hersteller</translation>
    </message>
    <message>
        <source>product</source>
        <translation>Produkt</translation>
    </message>
    <message>
        <source>coating</source>
        <translation>Beschichtung</translation>
    </message>
    <message>
        <source>thickness</source>
        <translation>Dicke</translation>
    </message>
    <message>
        <source>installed on</source>
        <translation>eingebaut am</translation>
    </message>
    <message>
        <source>warranty until</source>
        <translation>Gewährleistung bis</translation>
    </message>
    <message>
        <source>width</source>
        <translation>Breite</translation>
    </message>
    <message>
        <source>height</source>
        <translation>Höhe</translation>
    </message>
    <message>
        <source>open</source>
        <translation>offen</translation>
    </message>
    <message>
        <source>repaired</source>
        <translation>behoben</translation>
    </message>
    <message>
        <source>text</source>
        <translation>Text</translation>
    </message>
    <message>
        <source>number</source>
        <translation>Zahl</translation>
    </message>
    <message>
        <source>yes or no</source>
        <translation>ja oder nein</translation>
    </message>
    <message>
        <source>yes</source>
        <translation>ja</translation>
    </message>
    <message>
        <source>no</source>
        <translation>nein</translation>
    </message>
</context>
<context>
    <name>ReportMaker</name>
    <message>
        <source>the process that shows models has ended; try again</source>
        <translation>der Prozess, der Modelle zeigt, ist beendet; noch einmal versuchen</translation>
    </message>
    <message>
        <source>Panels of {0}</source>
        <translation>Scheiben von {0}</translation>
    </message>
    <message>
        <source>Model of {0}</source>
        <translation>Modell vom {0}</translation>
    </message>
    <message>
        <source>The building: {0}</source>
        <translation>Das Gebäude: {0}</translation>
    </message>
    <message>
        <source>Facade {0}</source>
        <translation>Fassade {0}</translation>
    </message>
    <message>
        <source>Facade</source>
        <translation>Fassade</translation>
    </message>
    <message>
        <source>Size</source>
        <translation>Größe</translation>
    </message>
    <message>
        <source>GlobalId</source>
        <translation>GlobalId</translation>
    </message>
    <message>
        <source>The picture cannot be read: {0}</source>
        <translation>Das Bild lässt sich nicht lesen: {0}</translation>
    </message>
    <message>
        <source>The file is missing or not the one that was attached: {0}</source>
        <translation>Die Datei fehlt oder ist nicht die, die angehängt wurde: {0}</translation>
    </message>
</context>
<context>
    <name>ReportView</name>
    <message>
        <source>Views of the flight</source>
        <translation>Aufnahmen des Flugs</translation>
    </message>
    <message>
        <source>Top-up flight</source>
        <translation>Ergänzungsflug</translation>
    </message>
    <message>
        <source>Plan the shortest flight that closes what is missing, with the battery left</source>
        <translation>Den kürzesten Flug planen, der schließt, was fehlt, mit dem Rest des Akkus</translation>
    </message>
    <message>
        <source>Resume sortie</source>
        <translation>Einsatz fortsetzen</translation>
    </message>
    <message>
        <source>Plan the rest of the sortie that was interrupted, for a full battery</source>
        <translation>Den Rest des unterbrochenen Einsatzes für einen vollen Akku planen</translation>
    </message>
    <message>
        <source>Fetch the autopilot&apos;s own log from its card, and report from it: it knows what the link lost</source>
        <translation>Das eigene Log des Autopiloten von seiner Karte holen und daraus berichten: es weiß, was die Verbindung verlor</translation>
    </message>
    <message>
        <source>Stop fetching</source>
        <translation>Holen abbrechen</translation>
    </message>
    <message>
        <source>Vehicle&apos;s log</source>
        <translation>Log des Fahrzeugs</translation>
    </message>
    <message>
        <source>After the landing, the flight report stands here.</source>
        <translation>Nach der Landung steht hier der Flugbericht.</translation>
    </message>
    <message>
        <source>Photos: {0} of {1} views; sections covered: {2} of {3} planned ({4:.1f} %)</source>
        <translation>Fotos: {0} von {1} Aufnahmen; abgedeckte Sektoren: {2} von {3} geplanten ({4:.1f} %)</translation>
    </message>
    <message>
        <source>Flown: {0}</source>
        <translation>Geflogen: {0}</translation>
    </message>
    <message>
        <source>Battery used: {0:.0%}</source>
        <translation>Akku verbraucht: {0:.0%}</translation>
    </message>
    <message>
        <source>Smallest distance kept: {0}</source>
        <translation>Kleinster Abstand: {0}</translation>
    </message>
    <message>
        <source>Panels that no photo shows: {0}</source>
        <translation>Scheiben, die kein Foto zeigt: {0}</translation>
    </message>
    <message>
        <source>Kept in {0}</source>
        <translation>Abgelegt in {0}</translation>
    </message>
    <message>
        <source>View</source>
        <translation>Aufnahme</translation>
    </message>
    <message>
        <source>Sortie</source>
        <translation>Einsatz</translation>
    </message>
    <message>
        <source>Photo</source>
        <translation>Foto</translation>
    </message>
    <message>
        <source>Place off</source>
        <translation>Ort</translation>
    </message>
    <message>
        <source>Heading off, deg</source>
        <translation>Richtung, Grad</translation>
    </message>
    <message>
        <source>Pitch off, deg</source>
        <translation>Neigung, Grad</translation>
    </message>
    <message>
        <source>Blur, px</source>
        <translation>Unschärfe, px</translation>
    </message>
    <message>
        <source>Distance</source>
        <translation>Abstand</translation>
    </message>
    <message>
        <source>taken</source>
        <translation>aufgenommen</translation>
    </message>
    <message>
        <source>sortie not flown</source>
        <translation>Einsatz nicht geflogen</translation>
    </message>
    <message>
        <source>not reached</source>
        <translation>nicht erreicht</translation>
    </message>
    <message>
        <source>no answer of the camera</source>
        <translation>Kamera antwortete nicht</translation>
    </message>
    <message>
        <source>taken, but its report was lost</source>
        <translation>aufgenommen, aber die Meldung ging verloren</translation>
    </message>
    <message>
        <source>taken too far away</source>
        <translation>zu weit weg aufgenommen</translation>
    </message>
    <message>
        <source>looks elsewhere</source>
        <translation>blickt woandershin</translation>
    </message>
    <message>
        <source>not reached, flight broken off</source>
        <translation>nicht erreicht, Flug abgebrochen</translation>
    </message>
    <message>
        <source>not recorded any more</source>
        <translation>nicht mehr aufgezeichnet</translation>
    </message>
    <message>
        <source>place not known</source>
        <translation>Ort unbekannt</translation>
    </message>
</context>
<context>
    <name>ScenePane</name>
    <message>
        <source>Facade</source>
        <translation>Fassade</translation>
    </message>
    <message>
        <source>Measure</source>
        <translation>Messen</translation>
    </message>
    <message>
        <source>Panel</source>
        <translation>Scheibe</translation>
    </message>
    <message>
        <source>Save ...</source>
        <translation>Sichern ...</translation>
    </message>
    <message>
        <source>nothing</source>
        <translation>nichts</translation>
    </message>
    <message>
        <source>none</source>
        <translation>keiner</translation>
    </message>
    <message>
        <source>height</source>
        <translation>Höhe</translation>
    </message>
    <message>
        <source>east</source>
        <translation>Ost</translation>
    </message>
    <message>
        <source>north</source>
        <translation>Nord</translation>
    </message>
    <message>
        <source>Where the section is</source>
        <translation>Wo der Schnitt liegt</translation>
    </message>
    <message>
        <source>other side</source>
        <translation>andere Seite</translation>
    </message>
    <message>
        <source>Click two places: how far they are apart</source>
        <translation>Zwei Stellen anklicken: wie weit sie auseinander sind</translation>
    </message>
    <message>
        <source>See the largest facade from the front (0)</source>
        <translation>Die größte Fassade von vorn sehen (0)</translation>
    </message>
    <message>
        <source>Save the picture as a file</source>
        <translation>Das Bild als Datei sichern</translation>
    </message>
    <message>
        <source>See the chosen panel from the front</source>
        <translation>Die gewählte Scheibe von vorn sehen</translation>
    </message>
    <message>
        <source>Layer</source>
        <translation>Ebene</translation>
    </message>
    <message>
        <source>Beside it</source>
        <translation>Daneben</translation>
    </message>
    <message>
        <source>Section</source>
        <translation>Schnitt</translation>
    </message>
    <message>
        <source>Open a model: the folder of a training that is finished.</source>
        <translation>Ein Modell öffnen: den Ordner eines fertigen Trainings.</translation>
    </message>
    <message>
        <source>Click two places.</source>
        <translation>Zwei Stellen anklicken.</translation>
    </message>
    <message>
        <source>{0}; {1} along the ground, {2} in height</source>
        <translation>{0}; {1} am Boden, {2} in der Höhe</translation>
    </message>
</context>
<context>
    <name>SceneTexts</name>
    <message>
        <source>Home</source>
        <translation>Startplatz</translation>
    </message>
    <message>
        <source>Panel {0}: in {1} views</source>
        <translation>Scheibe {0}: in {1} Aufnahmen</translation>
    </message>
    <message>
        <source>Viewpoint {0}: photo {1} of {2} of sortie {3}</source>
        <translation>Aufnahmepunkt {0}: Foto {1} von {2} in Einsatz {3}</translation>
    </message>
    <message>
        <source>Building</source>
        <translation>Gebäude</translation>
    </message>
    <message>
        <source>Sortie {0}, leg {1}</source>
        <translation>Einsatz {0}, Strecke {1}</translation>
    </message>
    <message>
        <source>Panel {0}</source>
        <translation>Scheibe {0}</translation>
    </message>
    <message>
        <source>Viewpoint {0}</source>
        <translation>Aufnahmepunkt {0}</translation>
    </message>
    <message>
        <source>covered; darker: by more views</source>
        <translation>abgedeckt; dunkler: von mehr Aufnahmen</translation>
    </message>
    <message>
        <source>open: could be covered</source>
        <translation>offen: erreichbar</translation>
    </message>
    <message>
        <source>unreachable</source>
        <translation>unerreichbar</translation>
    </message>
    <message>
        <source>undecided</source>
        <translation>unentschieden</translation>
    </message>
    <message>
        <source>Start and landing {0}</source>
        <translation>Start und Landung {0}</translation>
    </message>
    <message>
        <source>Start {0}, landing {1}</source>
        <translation>Start {0}, Landung {1}</translation>
    </message>
    <message>
        <source>Start {0}</source>
        <translation>Start {0}</translation>
    </message>
    <message>
        <source>Landing {0}</source>
        <translation>Landung {0}</translation>
    </message>
</context>
<context>
    <name>SceneView</name>
    <message>
        <source>Layers</source>
        <translation>Ebenen</translation>
    </message>
    <message>
        <source>What is shown in the view, and how strongly, sortie by sortie</source>
        <translation>Was in der Ansicht zu sehen ist und wie kräftig, Einsatz für Einsatz</translation>
    </message>
    <message>
        <source>Sortie {0}</source>
        <translation>Einsatz {0}</translation>
    </message>
    <message>
        <source>Routes</source>
        <translation>Routen</translation>
    </message>
    <message>
        <source>Viewpoints</source>
        <translation>Punkte</translation>
    </message>
    <message>
        <source>All pyramids</source>
        <translation>Alle Pyramiden</translation>
    </message>
    <message>
        <source>Panels</source>
        <translation>Scheiben</translation>
    </message>
    <message>
        <source>Building</source>
        <translation>Gebäude</translation>
    </message>
    <message>
        <source>Obstacles</source>
        <translation>Hindernisse</translation>
    </message>
    <message>
        <source>No-fly zones</source>
        <translation>Flugverbotszonen</translation>
    </message>
    <message>
        <source>Airspace</source>
        <translation>Luftraum</translation>
    </message>
    <message>
        <source>Home</source>
        <translation>Startplatz</translation>
    </message>
    <message>
        <source>Shadows</source>
        <translation>Schatten</translation>
    </message>
    <message>
        <source>Ground</source>
        <translation>Boden</translation>
    </message>
    <message>
        <source>Names</source>
        <translation>Namen</translation>
    </message>
</context>
<context>
    <name>SendDialog</name>
    <message>
        <source>Send to controller</source>
        <translation>An Fernsteuerung senden</translation>
    </message>
    <message>
        <source>DJI Pilot 2, imports files</source>
        <translation>DJI Pilot 2, importiert Dateien</translation>
    </message>
    <message>
        <source>DJI Fly, a route is replaced</source>
        <translation>DJI Fly, eine Route wird ersetzt</translation>
    </message>
    <message>
        <source>FlightHub 2, folder waylines</source>
        <translation>FlightHub 2, Ordner waylines</translation>
    </message>
    <message>
        <source>Look again</source>
        <translation>Erneut suchen</translation>
    </message>
    <message>
        <source>Look for cards and remote controllers that were connected meanwhile</source>
        <translation>Nach Karten und Fernsteuerungen suchen, die inzwischen angeschlossen wurden</translation>
    </message>
    <message>
        <source>Folder ...</source>
        <translation>Ordner ...</translation>
    </message>
    <message>
        <source>Send into a folder that you choose</source>
        <translation>In einen Ordner senden, den Sie wählen</translation>
    </message>
    <message>
        <source>No objections to these files.</source>
        <translation>Keine Einwände gegen diese Dateien.</translation>
    </message>
    <message>
        <source>Send</source>
        <translation>Senden</translation>
    </message>
    <message>
        <source>Device</source>
        <translation>Gerät</translation>
    </message>
    <message>
        <source>Read by</source>
        <translation>Gelesen von</translation>
    </message>
    <message>
        <source>Name there</source>
        <translation>Name dort</translation>
    </message>
    <message>
        <source>Looking for cards and remote controllers ...</source>
        <translation>Suche nach Karten und Fernsteuerungen ...</translation>
    </message>
    <message>
        <source>Look for devices</source>
        <translation>Geräte suchen</translation>
    </message>
    <message>
        <source>Send into this folder</source>
        <translation>In diesen Ordner senden</translation>
    </message>
    <message>
        <source>No card or remote controller is connected. On Windows and macOS a controller that is connected by USB has no path: use its card, or choose a folder.</source>
        <translation>Keine Karte oder Fernsteuerung ist angeschlossen. Unter Windows und macOS hat eine per USB angeschlossene Fernsteuerung keinen Pfad: Nehmen Sie ihre Karte oder wählen Sie einen Ordner.</translation>
    </message>
    <message>
        <source>Making the files ...</source>
        <translation>Dateien werden erstellt ...</translation>
    </message>
    <message>
        <source>Prepare export</source>
        <translation>Export vorbereiten</translation>
    </message>
    <message>
        <source>Cannot be sent: {0}</source>
        <translation>Kann nicht gesendet werden: {0}</translation>
    </message>
    <message>
        <source>Replaced by sortie {0}</source>
        <translation>Ersetzt durch Flug {0}</translation>
    </message>
    <message>
        <source>{0}, waypoints: {1}, {2}</source>
        <translation>{0}, Wegpunkte: {1}, {2}</translation>
    </message>
    <message>
        <source>Ready to be sent, files: {0}. Read the warnings.</source>
        <translation>Bereit zum Senden, Dateien: {0}. Lesen Sie die Warnungen.</translation>
    </message>
    <message>
        <source>Ready to be sent, files: {0}</source>
        <translation>Bereit zum Senden, Dateien: {0}</translation>
    </message>
    <message>
        <source>These files are replaced on {0}: {1}

Copies of them are kept on this computer.</source>
        <translation>Diese Dateien werden auf {0} ersetzt: {1}

Kopien von ihnen bleiben auf diesem Computer.</translation>
    </message>
    <message>
        <source>Replace files?</source>
        <translation>Dateien ersetzen?</translation>
    </message>
    <message>
        <source>Writing and reading back ...</source>
        <translation>Schreiben und Zurücklesen ...</translation>
    </message>
    <message>
        <source>Sent, read back and equal to the plan: {0}. Eject the device before you pull it out.</source>
        <translation>Gesendet, zurückgelesen und gleich dem Plan: {0}. Werfen Sie das Gerät aus, bevor Sie es abziehen.</translation>
    </message>
    <message>
        <source>What was replaced is kept: {0}</source>
        <translation>Was ersetzt wurde, ist aufbewahrt: {0}</translation>
    </message>
    <message>
        <source>Not sent: {0}</source>
        <translation>Nicht gesendet: {0}</translation>
    </message>
</context>
<context>
    <name>Sentences</name>
    <message>
        <source>the profile &apos;{0}&apos;</source>
        <translation>das Profil &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>no profile</source>
        <translation>kein Profil</translation>
    </message>
    <message>
        <source>a DJI mission names its aircraft and camera, but the plan has {0}; expected one of {1}; plan with one of them, or export for MAVLink</source>
        <translation>eine DJI-Mission nennt ihr Fluggerät und ihre Kamera, der Plan hat aber {0}; erwartet wurde eines von {1}; mit einem davon planen oder für MAVLink exportieren</translation>
    </message>
    <message>
        <source>there is no template.kml; DJI Pilot 2 and FlightHub 2 do not open the mission without it</source>
        <translation>es gibt keine template.kml; DJI Pilot 2 und FlightHub 2 öffnen die Mission ohne sie nicht</translation>
    </message>
    <message>
        <source>WPML {0} is not known; expected 1.0.x</source>
        <translation>WPML {0} ist nicht bekannt; erwartet wurde 1.0.x</translation>
    </message>
    <message>
        <source>expected a number: {0}</source>
        <translation>erwartet wurde eine Zahl: {0}</translation>
    </message>
    <message>
        <source>the aircraft flies slanted to the first waypoint (pointToPoint): check that way for obstacles</source>
        <translation>das Fluggerät fliegt schräg zum ersten Wegpunkt (pointToPoint): diesen Weg auf Hindernisse prüfen</translation>
    </message>
    <message>
        <source>flyToWaylineMode is &apos;{0}&apos;; expected safely or pointToPoint</source>
        <translation>flyToWaylineMode ist &apos;{0}&apos;; erwartet wurde safely oder pointToPoint</translation>
    </message>
    <message>
        <source>at the end the aircraft flies straight to the first waypoint: check that way for obstacles</source>
        <translation>am Ende fliegt das Fluggerät gerade zum ersten Wegpunkt: diesen Weg auf Hindernisse prüfen</translation>
    </message>
    <message>
        <source>finishAction &apos;{0}&apos; is not known</source>
        <translation>finishAction &apos;{0}&apos; ist nicht bekannt</translation>
    </message>
    <message>
        <source>executeLostAction needs an executeRCLostAction</source>
        <translation>executeLostAction braucht eine executeRCLostAction</translation>
    </message>
    <message>
        <source>exitOnRCLost &apos;{0}&apos; is not known</source>
        <translation>exitOnRCLost &apos;{0}&apos; ist nicht bekannt</translation>
    </message>
    <message>
        <source>there is no takeOffSecurityHeight</source>
        <translation>es gibt keine takeOffSecurityHeight</translation>
    </message>
    <message>
        <source>takeOffSecurityHeight is out of range</source>
        <translation>takeOffSecurityHeight liegt außerhalb des Erlaubten</translation>
    </message>
    <message>
        <source>globalTransitionalSpeed must be above 0 and at most {0} m/s</source>
        <translation>globalTransitionalSpeed muss über 0 und höchstens {0} m/s sein</translation>
    </message>
    <message>
        <source>globalRTHHeight is missing: the remote controller&apos;s own setting holds</source>
        <translation>globalRTHHeight fehlt: Es gilt die Einstellung der Fernsteuerung</translation>
    </message>
    <message>
        <source>droneInfo or payloadInfo is missing</source>
        <translation>droneInfo oder payloadInfo fehlt</translation>
    </message>
    <message>
        <source>the aircraft {0}-{1} is not known here, so its cameras are not checked</source>
        <translation>das Fluggerät {0}-{1} ist hier nicht bekannt, seine Kameras sind also nicht geprüft</translation>
    </message>
    <message>
        <source>the aircraft {0}-{1} does not carry the camera {2}; expected one of {3}</source>
        <translation>das Fluggerät {0}-{1} trägt die Kamera {2} nicht; erwartet wurde eine von {3}</translation>
    </message>
    <message>
        <source>there is no wayline</source>
        <translation>es gibt keine Wayline</translation>
    </message>
    <message>
        <source>wayline {0}, </source>
        <translation>Wayline {0}, </translation>
    </message>
    <message>
        <source>waypointGimbalHeadingParam is missing</source>
        <translation>waypointGimbalHeadingParam fehlt</translation>
    </message>
    <message>
        <source>the wayline lasts longer than the aircraft flies on one battery; split it</source>
        <translation>die Wayline dauert länger, als das Fluggerät mit einem Akku fliegt; sie teilen</translation>
    </message>
    <message>
        <source>
sortie {0} comes next: put in a full battery, then press Enter</source>
        <translation>
Einsatz {0} ist der nächste: einen vollen Akku einsetzen, dann Enter drücken</translation>
    </message>
    <message>
        <source>  &apos;{0}&apos; had {1} % of its own final coverage after {2}</source>
        <translation>  &apos;{0}&apos; hatte {1} % der eigenen endgültigen Abdeckung nach {2}</translation>
    </message>
    <message>
        <source>  after {0} s: {1}</source>
        <translation>  nach {0} s: {1}</translation>
    </message>
    <message>
        <source>  at most {0} of {1} sections of {2}° can be covered</source>
        <translation>  höchstens {0} von {1} Sektoren zu {2}° sind abzudecken</translation>
    </message>
    <message>
        <source>  best in sections of {0}°: &apos;{1}&apos;</source>
        <translation>  am besten in Sektoren zu {0}°: &apos;{1}&apos;</translation>
    </message>
    <message>
        <source>  facade {0}: {1} in {2} and {3}, from {4}; corners good to {5} m</source>
        <translation>  Fassade {0}: {1} in {2} und {3}, aus {4}; Ecken auf {5} m genau</translation>
    </message>
    <message>
        <source>  mirrored light: {0}{1}</source>
        <translation>  Spiegellicht: {0}{1}</translation>
    </message>
    <message>
        <source>  off by up to {0} px in the photo</source>
        <translation>  daneben um bis zu {0} px im Foto</translation>
    </message>
    <message>
        <source>  reflections learned from photos, scored on glass of unseen views that have all that the scene calls for:</source>
        <translation>  Spiegelungen, aus Fotos gelernt, bewertet auf Glas neuer Ansichten, die alles haben, was die Szene verlangt:</translation>
    </message>
    <message>
        <source>  sortie {0}, on {1}: {2}, {3} m, {4} min</source>
        <translation>  Einsatz {0}, mit {1}: {2}, {3} m, {4} min</translation>
    </message>
    <message>
        <source>  sortie {0}: {1}, {2} m, {3} min</source>
        <translation>  Einsatz {0}: {1}, {2} m, {3} min</translation>
    </message>
    <message>
        <source>  {0}  found no tour</source>
        <translation>  {0}  fand keine Rundtour</translation>
    </message>
    <message>
        <source>  {0} in {1} s{2}</source>
        <translation>  {0} in {1} s{2}</translation>
    </message>
    <message>
        <source>  {0} panels missed, {1} false ones found</source>
        <translation>  {0} Scheiben übersehen, {1} falsche gefunden</translation>
    </message>
    <message>
        <source>  {0} points, nothing is shorter than {1}{2}</source>
        <translation>  {0} Punkte, nichts ist kürzer als {1}{2}</translation>
    </message>
    <message>
        <source>  {0} s a photo, {1} s at most</source>
        <translation>  {0} s je Foto, höchstens {1} s</translation>
    </message>
    <message>
        <source>  {0}: {1}{2}, {3} in {4} ({5}, {6})</source>
        <translation>  {0}: {1}{2}, {3} in {4} ({5}, {6})</translation>
    </message>
    <message>
        <source>  {0}{1}{2}  best after {3}</source>
        <translation>  {0}{1}{2}  am besten nach {3}</translation>
    </message>
    <message>
        <source> ({0} predicted)</source>
        <translation> (vorhergesagt {0})</translation>
    </message>
    <message>
        <source> ({0} times, the first: {1})</source>
        <translation> ({0}-mal, zuerst: {1})</translation>
    </message>
    <message>
        <source>&apos;{0}&apos; is given twice</source>
        <translation>&apos;{0}&apos; ist zweimal angegeben</translation>
    </message>
    <message>
        <source>&apos;{0}&apos; stands in line {1} already</source>
        <translation>&apos;{0}&apos; steht schon in Zeile {1}</translation>
    </message>
    <message>
        <source>&apos;{0}&apos; wins with {1} of what can be covered, after {2} ({3} views)</source>
        <translation>&apos;{0}&apos; gewinnt mit {1} des Möglichen, nach {2} ({3} Aufnahmen)</translation>
    </message>
    <message>
        <source>&apos;{0}&apos; wins with {1}, {2} to {3}, after {4}</source>
        <translation>&apos;{0}&apos; gewinnt mit {1}, {2} gegen {3}, nach {4}</translation>
    </message>
    <message>
        <source>&apos;{0}&apos;: expected NAME=VALUE</source>
        <translation>&apos;{0}&apos;: erwartet wird NAME=WERT</translation>
    </message>
    <message>
        <source>&apos;{0}&apos;: expected float, found another type</source>
        <translation>&apos;{0}&apos;: erwartet wird float, gefunden wurde ein anderer Typ</translation>
    </message>
    <message>
        <source>&apos;{0}&apos;: expected one of {1}</source>
        <translation>&apos;{0}&apos;: erwartet wird eines von {1}</translation>
    </message>
    <message>
        <source>, as you asked</source>
        <translation>, wie verlangt</translation>
    </message>
    <message>
        <source>, asked for</source>
        <translation>, verlangt</translation>
    </message>
    <message>
        <source>, blur {0} px in the middle</source>
        <translation>, Unschärfe {0} px in der Mitte</translation>
    </message>
    <message>
        <source>, computed before</source>
        <translation>, früher berechnet</translation>
    </message>
    <message>
        <source>, itself good to {0} grey levels</source>
        <translation>, selbst auf {0} Graustufen genau</translation>
    </message>
    <message>
        <source>, known optimum {0}</source>
        <translation>, bekanntes Optimum {0}</translation>
    </message>
    <message>
        <source>, left out</source>
        <translation>, weggelassen</translation>
    </message>
    <message>
        <source>, open: {0} ({1})</source>
        <translation>, offen: {0} ({1})</translation>
    </message>
    <message>
        <source>, {0} % of what is possible</source>
        <translation>, {0} % des Möglichen</translation>
    </message>
    <message>
        <source>, {0} further</source>
        <translation>, {0} weitere</translation>
    </message>
    <message>
        <source>, {0} m</source>
        <translation>, {0} m</translation>
    </message>
    <message>
        <source>, {0} min below {1} m</source>
        <translation>, {0} min unter {1} m</translation>
    </message>
    <message>
        <source>, {0} of them kept</source>
        <translation>, {0} davon behalten</translation>
    </message>
    <message>
        <source>, {0} of them without a grid</source>
        <translation>, {0} davon ohne Raster</translation>
    </message>
    <message>
        <source>, {0} s left</source>
        <translation>, noch {0} s</translation>
    </message>
    <message>
        <source>, {0} smaller ones</source>
        <translation>, {0} kleinere</translation>
    </message>
    <message>
        <source>distance: there is no photo &apos;{0}&apos;; name it as it lies below the folder</source>
        <translation>Strecke: es gibt kein Foto &apos;{0}&apos;; nennen Sie es so, wie es unter dem Ordner liegt</translation>
    </message>
    <message>
        <source>--effects, --wind and --speedup are for --link sim; the vehicle at a link has its own</source>
        <translation>--effects, --wind und --speedup sind für --link sim; das Fluggerät an einem Link hat eigene</translation>
    </message>
    <message>
        <source>    question: {0}</source>
        <translation>    Frage: {0}</translation>
    </message>
    <message>
        <source>  sortie {0}: {1}, {2} m, {3} min, aircraft {4} starts at {5}</source>
        <translation>  Einsatz {0}: {1}, {2} m, {3} min, Fluggerät {4} startet bei {5}</translation>
    </message>
    <message>
        <source>  the vehicle knows no checksums: this log is not proved</source>
        <translation>  das Fahrzeug kennt keine Prüfsummen: dieses Log ist nicht bewiesen</translation>
    </message>
    <message>
        <source>  what it replaced is kept: {0}</source>
        <translation>  was sie ersetzt hat, ist aufbewahrt: {0}</translation>
    </message>
    <message>
        <source>  {0}  {1}  {2}</source>
        <translation>  {0}  {1}  {2}</translation>
    </message>
    <message>
        <source>% of the walls</source>
        <translation>% der Wände</translation>
    </message>
    <message>
        <source>&apos;{0}&apos; cannot be read, it is &apos;{1}&apos;</source>
        <translation>&apos;{0}&apos; ist nicht lesbar, dort steht &apos;{1}&apos;</translation>
    </message>
    <message>
        <source>&apos;{0}&apos; is nothing that heights are above; expected ellipsoid, egm96, egm2008 or the code of a height system such as EPSG:7837</source>
        <translation>&apos;{0}&apos; ist nichts, worüber Höhen gezählt werden; erwartet: ellipsoid, egm96, egm2008 oder der Code eines Höhensystems wie EPSG:7837</translation>
    </message>
    <message>
        <source>&apos;{0}&apos;, added on {1}</source>
        <translation>&apos;{0}&apos;, hinzugefügt am {1}</translation>
    </message>
    <message>
        <source>--into and --site are for IFC; expected a name ending in .ifc</source>
        <translation>--into und --site sind für IFC; erwartet wird ein Name mit der Endung .ifc</translation>
    </message>
    <message>
        <source>--jobs is for this machine; leave it out, or --cluster</source>
        <translation>--jobs ist für diesen Rechner; dieses oder --cluster weglassen</translation>
    </message>
    <message>
        <source>--open and --screenshots are for the window, which opens without a command</source>
        <translation>--open und --screenshots sind für das Fenster, das ohne Befehl aufgeht</translation>
    </message>
    <message>
        <source>--rays is for Mitsuba; add --renderer mitsuba, or leave it out</source>
        <translation>--rays ist für Mitsuba; --renderer mitsuba dazunehmen oder --rays weglassen</translation>
    </message>
    <message>
        <source>--resume goes on with the settings that the training was begun with; leave {0} out</source>
        <translation>--resume macht mit den Einstellungen weiter, mit denen das Training begonnen wurde; {0} weglassen</translation>
    </message>
    <message>
        <source>--set folder: needs photos and index images; name both with --images and --truth</source>
        <translation>--set folder: braucht Fotos und Indexbilder; beide mit --images und --truth nennen</translation>
    </message>
    <message>
        <source>--site goes with a new IFC file; leave out --into or --site</source>
        <translation>--site gehört zu einer neuen IFC-Datei; --into oder --site weglassen</translation>
    </message>
    <message>
        <source>--site without a command is for --screenshots</source>
        <translation>--site ohne Befehl ist für --screenshots</translation>
    </message>
    <message>
        <source>--take-off, --set-parameters, --raise and --overrule are for --link URL; nothing real moves here</source>
        <translation>--take-off, --set-parameters, --raise und --overrule sind für --link URL; hier bewegt sich nichts Echtes</translation>
    </message>
    <message>
        <source>--views, --rectified-by: the photos of &apos;{0}&apos; have no poses, which both need; take a synthetic set: {1}</source>
        <translation>--views, --rectified-by: die Fotos von &apos;{0}&apos; haben keine Posen, die beide brauchen; einen erzeugten Satz nehmen: {1}</translation>
    </message>
    <message>
        <source>1 battery</source>
        <translation>1 Akku</translation>
    </message>
    <message>
        <source>; with take-off at {0} it would be {1}</source>
        <translation>; mit Start um {0} wären es {1}</translation>
    </message>
    <message>
        <source>; {0} panels lost</source>
        <translation>; {0} Scheiben verloren</translation>
    </message>
    <message>
        <source>A folder with one page that shows the model and all records in any browser, without a network.</source>
        <translation>Ein Ordner mit einer Seite, die das Modell und alle Einträge in jedem Browser zeigt, ohne Netz.</translation>
    </message>
    <message>
        <source>A folder with splats and panels in tiles, placed on Earth, as CesiumJS shows them.</source>
        <translation>Ein Ordner mit Splats und Scheiben in Kacheln, auf der Erde verortet, wie CesiumJS sie zeigt.</translation>
    </message>
    <message>
        <source>ArduPilot, dataflash log</source>
        <translation>ArduPilot, Dataflash-Log</translation>
    </message>
    <message>
        <source>COLMAP model: the rational distortion of camera {0} is {1} px from the nearest polynomial; expected at most {2} px; undistort the images in COLMAP (image_undistorter)</source>
        <translation>COLMAP-Modell: die rationale Verzeichnung der Kamera {0} ist {1} px vom nächsten Polynom entfernt; erwartet werden höchstens {2} px; die Bilder in COLMAP entzerren (image_undistorter)</translation>
    </message>
    <message>
        <source>Check</source>
        <translation>Prüfen</translation>
    </message>
    <message>
        <source>Connect</source>
        <translation>Verbinden</translation>
    </message>
    <message>
        <source>DJI (.kmz)</source>
        <translation>DJI (.kmz)</translation>
    </message>
    <message>
        <source>DJI Fly has no import, so each sortie replaces a route that is there: choose {0} of the {1} routes; make more in DJI Fly where there are too few</source>
        <translation>DJI Fly hat keinen Import, also ersetzt jeder Flug eine Route, die dort ist: wählen Sie {0} der {1} Routen; legen Sie in DJI Fly weitere an, wo es zu wenige sind</translation>
    </message>
    <message>
        <source>DJI Fly was not tried with this route: it is written for {0}, which DJI Pilot 2 flies; look at every waypoint in DJI Fly before take-off</source>
        <translation>DJI Fly wurde mit dieser Route nicht erprobt: Sie ist für {0} geschrieben, das DJI Pilot 2 fliegt; sehen Sie vor dem Start jeden Wegpunkt in DJI Fly an</translation>
    </message>
    <message>
        <source>EGM96 stands in for &apos;{0}&apos;, which may be off by 1 m, in mountains by 2 m; home stands on the same terrain, so heights above take-off do not change</source>
        <translation>EGM96 steht für &apos;{0}&apos; ein, was um 1 m falsch sein kann, im Gebirge um 2 m; der Startplatz steht auf demselben Gelände, Höhen über dem Start ändern sich also nicht</translation>
    </message>
    <message>
        <source>Export</source>
        <translation>Exportieren</translation>
    </message>
    <message>
        <source>Facade grid</source>
        <translation>Fassadenraster</translation>
    </message>
    <message>
        <source>Find panels</source>
        <translation>Scheiben suchen</translation>
    </message>
    <message>
        <source>From photos alone</source>
        <translation>Aus Fotos allein</translation>
    </message>
    <message>
        <source>Google Earth (.kml), to look at</source>
        <translation>Google Earth (.kml), zum Ansehen</translation>
    </message>
    <message>
        <source>Hemisphere section</source>
        <translation>Sektor der Halbkugel</translation>
    </message>
    <message>
        <source>Ipopt found no speed profile: {0}</source>
        <translation>Ipopt fand kein Geschwindigkeitsprofil: {0}</translation>
    </message>
    <message>
        <source>Make data set</source>
        <translation>Datensatz erstellen</translation>
    </message>
    <message>
        <source>Mesh (glTF)</source>
        <translation>Netz (glTF)</translation>
    </message>
    <message>
        <source>Mission Planner (.waypoints)</source>
        <translation>Mission Planner (.waypoints)</translation>
    </message>
    <message>
        <source>Mitsuba is installed but does not work here ({0}); use the embedded renderer</source>
        <translation>Mitsuba ist installiert, läuft hier aber nicht ({0}); den eingebauten Renderer benutzen</translation>
    </message>
    <message>
        <source>Mitsuba is not installed; install it (pip install &apos;reflight-groundstation[mitsuba]&apos;), or use the embedded renderer</source>
        <translation>Mitsuba ist nicht installiert; installieren (pip install &apos;reflight-groundstation[mitsuba]&apos;) oder den eingebauten Renderer benutzen</translation>
    </message>
    <message>
        <source>Mitsuba, {0} rays</source>
        <translation>Mitsuba, {0} Strahlen</translation>
    </message>
    <message>
        <source>Open the model</source>
        <translation>Modell öffnen</translation>
    </message>
    <message>
        <source>Panels with pictures of their fronts, for programs that know no splats.</source>
        <translation>Scheiben mit Bildern ihrer Vorderseite, für Programme ohne Splats.</translation>
    </message>
    <message>
        <source>Plan the flight</source>
        <translation>Den Flug planen</translation>
    </message>
    <message>
        <source>PyVRP found no tour of all {0} points by existing legs; more time may help</source>
        <translation>PyVRP fand keine Rundtour durch alle {0} Punkte über vorhandene Strecken; mehr Zeit kann helfen</translation>
    </message>
    <message>
        <source>QGroundControl (.plan)</source>
        <translation>QGroundControl (.plan)</translation>
    </message>
    <message>
        <source>Read photos</source>
        <translation>Fotos lesen</translation>
    </message>
    <message>
        <source>Reflight failed where it should not ({0}: {1}); please report it with {2}</source>
        <translation>Reflight versagte, wo es nicht sollte ({0}: {1}); bitte mit {2} melden</translation>
    </message>
    <message>
        <source>Show the first</source>
        <translation>Den ersten zeigen</translation>
    </message>
    <message>
        <source>Splats and panels for film and simulation programs.</source>
        <translation>Splats und Scheiben für Film- und Simulationsprogramme.</translation>
    </message>
    <message>
        <source>Splats as ellipsoids: SuperSplat and nearly all viewers open it. Large.</source>
        <translation>Splats als Ellipsoide: SuperSplat und fast alle Betrachter öffnen es. Groß.</translation>
    </message>
    <message>
        <source>Splats as flat discs, as they were learned.</source>
        <translation>Splats als flache Scheiben, wie sie gelernt wurden.</translation>
    </message>
    <message>
        <source>Splats, and panels to pick with their GlobalIds and attributes, in one file.</source>
        <translation>Splats, und Scheiben zum Anklicken mit GlobalIds und Merkmalen, in einer Datei.</translation>
    </message>
    <message>
        <source>Splats, compressed most: for SuperSplat and PlayCanvas.</source>
        <translation>Splats, am stärksten komprimiert: für SuperSplat und PlayCanvas.</translation>
    </message>
    <message>
        <source>Splats, compressed: most viewers of splats open it.</source>
        <translation>Splats, komprimiert: die meisten Betrachter von Splats öffnen es.</translation>
    </message>
    <message>
        <source>Start</source>
        <translation>Start</translation>
    </message>
    <message>
        <source>Start page</source>
        <translation>Startseite</translation>
    </message>
    <message>
        <source>Stop and keep</source>
        <translation>Stopp, behalten</translation>
    </message>
    <message>
        <source>Table of photos (.csv)</source>
        <translation>Tabelle der Fotos (.csv)</translation>
    </message>
    <message>
        <source>The newer version of SPZ: smaller, for the newest programs.</source>
        <translation>Die neuere Fassung von SPZ: kleiner, für die neuesten Programme.</translation>
    </message>
    <message>
        <source>The panels alone, as plates of curtain walls, with their property sets.</source>
        <translation>Nur die Scheiben, als Platten von Vorhangfassaden, mit ihren Eigenschaftssätzen.</translation>
    </message>
    <message>
        <source>The panels alone, as windows of the building, with their attributes.</source>
        <translation>Nur die Scheiben, als Fenster des Gebäudes, mit ihren Merkmalen.</translation>
    </message>
    <message>
        <source>To Fly</source>
        <translation>Zum Flug</translation>
    </message>
    <message>
        <source>To Mission</source>
        <translation>Zur Mission</translation>
    </message>
    <message>
        <source>To Model</source>
        <translation>Zum Modell</translation>
    </message>
    <message>
        <source>To Photos</source>
        <translation>Zu den Fotos</translation>
    </message>
    <message>
        <source>To Plan</source>
        <translation>Zum Plan</translation>
    </message>
    <message>
        <source>To Reconstruct</source>
        <translation>Zur Rekonstruktion</translation>
    </message>
    <message>
        <source>To Site</source>
        <translation>Zum Standort</translation>
    </message>
    <message>
        <source>Train</source>
        <translation>Trainieren</translation>
    </message>
    <message>
        <source>U-space: flights with an authorisation of its service only</source>
        <translation>U-space: Flüge nur mit Genehmigung seines Dienstes</translation>
    </message>
    <message>
        <source>Upload</source>
        <translation>Hochladen</translation>
    </message>
    <message>
        <source>WORLD_SIZE is &apos;{0}&apos;, but RANK is no number; start the processes with torchrun</source>
        <translation>WORLD_SIZE ist &apos;{0}&apos;, aber RANK ist keine Zahl; die Prozesse mit torchrun starten</translation>
    </message>
    <message>
        <source>Web page</source>
        <translation>Webseite</translation>
    </message>
    <message>
        <source>a 3-D point has a coordinate that is not finite</source>
        <translation>ein 3-D-Punkt hat eine Koordinate, die nicht endlich ist</translation>
    </message>
    <message>
        <source>a CVRP needs several routes; expected a TSP or ATSP</source>
        <translation>ein CVRP braucht mehrere Routen; erwartet wird ein TSP oder ATSP</translation>
    </message>
    <message>
        <source>a bare site around them, without building and panels</source>
        <translation>ein leerer Standort darum herum, ohne Gebäude und Scheiben</translation>
    </message>
    <message>
        <source>a circle has no centre or no radius that can be used</source>
        <translation>ein Kreis hat keinen brauchbaren Mittelpunkt oder Radius</translation>
    </message>
    <message>
        <source>a cluster ({0}) needs Dask: pip install &apos;reflight-groundstation[cluster]&apos;</source>
        <translation>ein Cluster ({0}) braucht Dask: pip install &apos;reflight-groundstation[cluster]&apos;</translation>
    </message>
    <message>
        <source>a coarse model needs at least {0} photos of one camera; of {1} photos, {2} are of the {3} camera; choose another camera</source>
        <translation>ein Grobmodell braucht mindestens {0} Fotos einer Kamera; von {1} Fotos sind {2} von der Kamera {3}; wählen Sie eine andere Kamera</translation>
    </message>
    <message>
        <source>a coarse model needs at least {0} photos, got {1}</source>
        <translation>ein Grobmodell braucht mindestens {0} Fotos, es sind {1}</translation>
    </message>
    <message>
        <source>a fence has a radius of {0} m; expected more than 0</source>
        <translation>ein Geofence hat einen Radius von {0} m; erwartet wird mehr als 0</translation>
    </message>
    <message>
        <source>a fence has {0} corners; expected at least {1}</source>
        <translation>ein Geofence hat {0} Ecken; erwartet werden mindestens {1}</translation>
    </message>
    <message>
        <source>a file of control points or of a camera</source>
        <translation>eine Datei mit Passpunkten oder einer Kamera</translation>
    </message>
    <message>
        <source>a file of geo-zones</source>
        <translation>eine Datei mit Geozonen</translation>
    </message>
    <message>
        <source>a full battery</source>
        <translation>einem vollen Akku</translation>
    </message>
    <message>
        <source>a grid in steps of {0} m has more than {1} nodes below this airspace; allow a longer step</source>
        <translation>ein Raster in Schritten von {0} m hat unter diesem Luftraum mehr als {1} Knoten; eine größere Schrittweite erlauben</translation>
    </message>
    <message>
        <source>a height is counted from &apos;{0}&apos;; expected AGL, AMSL or WGS84</source>
        <translation>eine Höhe zählt ab &apos;{0}&apos;; erwartet wird AGL, AMSL oder WGS84</translation>
    </message>
    <message>
        <source>a height is in &apos;{0}&apos;; expected metres or feet</source>
        <translation>eine Höhe steht in &apos;{0}&apos;; erwartet werden Meter oder Fuß</translation>
    </message>
    <message>
        <source>a map in PMTiles format</source>
        <translation>eine Karte im Format PMTiles</translation>
    </message>
    <message>
        <source>a mesh does not tell windows from walls; state where the panels are, for example --panel-grid &apos;0,0,0 36,0,0 0,0,42&apos; --rows 14 --columns 20 (lower left, lower right and upper left corner of a facade, seen from outside), or import the building alone with --without-panels and find them in photos with &apos;panels&apos;</source>
        <translation>ein Netz unterscheidet Fenster nicht von Wänden; angeben, wo die Scheiben sind, zum Beispiel --panel-grid &apos;0,0,0 36,0,0 0,0,42&apos; --rows 14 --columns 20 (Ecken einer Fassade unten links, unten rechts und oben links, von außen gesehen), oder das Gebäude allein mit --without-panels importieren und sie mit &apos;panels&apos; in Fotos finden</translation>
    </message>
    <message>
        <source>a model is being trained</source>
        <translation>ein Modell wird trainiert</translation>
    </message>
    <message>
        <source>a model is trained</source>
        <translation>ein Modell ist trainiert</translation>
    </message>
    <message>
        <source>a number of views is for scenes without a plan or flight; leave it out, or them</source>
        <translation>eine Zahl von Aufnahmen ist für Szenen ohne Plan oder Flug; sie oder diese weglassen</translation>
    </message>
    <message>
        <source>a path needs two views or more to go through; leave --frames out</source>
        <translation>ein Weg braucht zwei oder mehr Ansichten; --frames weglassen</translation>
    </message>
    <message>
        <source>a plan is being made</source>
        <translation>ein Plan entsteht</translation>
    </message>
    <message>
        <source>a polynomial of degree {0} needs at least {1} points, found {2}</source>
        <translation>ein Polynom vom Grad {0} braucht mindestens {1} Punkte, gefunden wurden {2}</translation>
    </message>
    <message>
        <source>a process that rendered ended by itself, perhaps for want of memory; complete photos stay in {0}: run it again with fewer processes (--jobs 1) or smaller pictures (--width)</source>
        <translation>ein Prozess beim Rendern endete von selbst, vielleicht aus Mangel an Speicher; fertige Fotos bleiben in {0}: noch einmal mit weniger Prozessen (--jobs 1) oder kleineren Bildern (--width) starten</translation>
    </message>
    <message>
        <source>a radius of {0} m bends lines of the grid by up to {1} px</source>
        <translation>ein Radius von {0} m biegt Linien des Rasters um bis zu {1} px</translation>
    </message>
    <message>
        <source>a restriction that the file does not name</source>
        <translation>eine Beschränkung, die die Datei nicht nennt</translation>
    </message>
    <message>
        <source>a site alone has no viewpoints to fly to; name a plan as well</source>
        <translation>ein Standort allein hat keine Aufnahmepunkte zum Anfliegen; auch einen Plan nennen</translation>
    </message>
    <message>
        <source>a table of tilts</source>
        <translation>eine Tabelle von Neigungen</translation>
    </message>
    <message>
        <source>a time</source>
        <translation>eine Zeit</translation>
    </message>
    <message>
        <source>a worker could not render it: {0}</source>
        <translation>ein Worker konnte es nicht rendern: {0}</translation>
    </message>
    <message>
        <source>a {0} has no field &apos;{1}&apos;; known are {2}</source>
        <translation>{0} hat kein Feld &apos;{1}&apos;; bekannt sind {2}</translation>
    </message>
    <message>
        <source>a {0} has no width; it counts with {1} m to each side</source>
        <translation>ein {0} hat keine Breite; es zählt mit {1} m zu jeder Seite</translation>
    </message>
    <message>
        <source>about {0} million heights lie below the airspace, expected at most {1} million; give a coarser file</source>
        <translation>unter dem Luftraum liegen etwa {0} Millionen Höhen, erwartet höchstens {1} Millionen; eine gröbere Datei angeben</translation>
    </message>
    <message>
        <source>above {0} and below {1}</source>
        <translation>über {0} und unter {1}</translation>
    </message>
    <message>
        <source>added on {0}</source>
        <translation>hinzugefügt am {0}</translation>
    </message>
    <message>
        <source>added or changed: {0}</source>
        <translation>dazugekommen oder geändert: {0}</translation>
    </message>
    <message>
        <source>after {0} with &apos;{1}&apos;</source>
        <translation>nach {0} mit &apos;{1}&apos;</translation>
    </message>
    <message>
        <source>all checks passed</source>
        <translation>alle Prüfungen bestanden</translation>
    </message>
    <message>
        <source>all checks passed; mission files are written</source>
        <translation>alle Prüfungen bestanden; Missionsdateien sind geschrieben</translation>
    </message>
    <message>
        <source>ambiguous option: %(option)s could match %(matches)s</source>
        <translation>mehrdeutige Option: %(option)s kann %(matches)s sein</translation>
    </message>
    <message>
        <source>an aircraft that leaves its mission returns {0} m above take-off, though the airspace ends at {1} m: DJI&apos;s remote controllers take no less</source>
        <translation>ein Fluggerät, das seine Mission verlässt, kehrt {0} m über dem Startplatz zurück, obwohl der Luftraum bei {1} m endet: weniger nehmen DJIs Fernsteuerungen nicht an</translation>
    </message>
    <message>
        <source>an aircraft that leaves its mission returns {0} m above take-off, where {1} m would do: DJI&apos;s remote controllers take no less</source>
        <translation>ein Fluggerät, das seine Mission verlässt, kehrt {0} m über dem Startplatz zurück, wo {1} m genügen würden: weniger nehmen DJIs Fernsteuerungen nicht an</translation>
    </message>
    <message>
        <source>an aircraft that returns by itself would fly {0}; raise the ceiling of the airspace</source>
        <translation>ein Fluggerät, das von selbst zurückkehrt, flöge {0}; die Obergrenze des Luftraums anheben</translation>
    </message>
    <message>
        <source>an area has no outline</source>
        <translation>eine Fläche hat keinen Umriss</translation>
    </message>
    <message>
        <source>an outline lies on earth only if latitude and longitude are exchanged</source>
        <translation>ein Umriss liegt nur auf der Erde, wenn Breite und Länge vertauscht werden</translation>
    </message>
    <message>
        <source>an unknown camera</source>
        <translation>einer unbekannten Kamera</translation>
    </message>
    <message>
        <source>another mission of this name is there; send it under another name, or allow to replace it</source>
        <translation>eine andere Mission dieses Namens ist dort; senden Sie sie unter einem anderen Namen, oder erlauben Sie das Ersetzen</translation>
    </message>
    <message>
        <source>argument %(argument_name)s: %(message)s</source>
        <translation>Argument %(argument_name)s: %(message)s</translation>
    </message>
    <message>
        <source>arranging blocks</source>
        <translation>Baukörper werden gebildet</translation>
    </message>
    <message>
        <source>at most {0} longer than the shortest</source>
        <translation>höchstens {0} länger als die kürzeste</translation>
    </message>
    <message>
        <source>at the shutter (median / worst): {0}</source>
        <translation>beim Auslösen (Median / schlechteste): {0}</translation>
    </message>
    <message>
        <source>begin with a building model, photos of a first flight, or a mission of another program</source>
        <translation>mit einem Gebäudemodell, Fotos eines ersten Flugs oder der Mission eines anderen Programms beginnen</translation>
    </message>
    <message>
        <source>belongs to --photos</source>
        <translation>gehört zu --photos</translation>
    </message>
    <message>
        <source>belongs to --refine, which was not given</source>
        <translation>gehört zu --refine, das nicht angegeben wurde</translation>
    </message>
    <message>
        <source>below the building the files have no heights; those beside it were taken</source>
        <translation>unter dem Gebäude haben die Dateien keine Höhen; die daneben wurden genommen</translation>
    </message>
    <message>
        <source>below the ground, or where it is not known</source>
        <translation>unter dem Boden, oder wo er nicht bekannt ist</translation>
    </message>
    <message>
        <source>best</source>
        <translation>beste</translation>
    </message>
    <message>
        <source>blur</source>
        <translation>Unschärfe</translation>
    </message>
    <message>
        <source>bodies of the site take so much sun from a pane on this day</source>
        <translation>so viel Sonne nehmen Körper des Standorts einer Scheibe an diesem Tag</translation>
    </message>
    <message>
        <source>bundled scenes have a look of their own; name a site file to give one, or leave it out</source>
        <translation>mitgelieferte Szenen haben ein eigenes Aussehen; dafür eine Standortdatei nennen oder es weglassen</translation>
    </message>
    <message>
        <source>byte {0} says that {1} entries follow, but the {2} bytes left hold at most {3}; the file is damaged or cut off: write it again</source>
        <translation>Byte {0} sagt, dass {1} Einträge folgen, aber die restlichen {2} Bytes fassen höchstens {3}; die Datei ist beschädigt oder abgeschnitten: neu schreiben</translation>
    </message>
    <message>
        <source>cannot be read as a GeoTIFF ({0}); copy it again</source>
        <translation>kann nicht als GeoTIFF gelesen werden ({0}); noch einmal kopieren</translation>
    </message>
    <message>
        <source>cannot be read as weights (safetensors, or tensors that torch.save wrote); get the file again</source>
        <translation>nicht als Gewichte lesbar (safetensors, oder Tensoren von torch.save); die Datei neu holen</translation>
    </message>
    <message>
        <source>cannot be run ({0}); name an arducopter</source>
        <translation>nicht ausführbar ({0}); ein arducopter nennen</translation>
    </message>
    <message>
        <source>cannot be sent: {0}</source>
        <translation>kann nicht gesendet werden: {0}</translation>
    </message>
    <message>
        <source>cannot be written ({0}); send again</source>
        <translation>kann nicht geschrieben werden ({0}); senden Sie erneut</translation>
    </message>
    <message>
        <source>cannot be written; check the folder, or that no other program holds the file</source>
        <translation>nicht zu schreiben; den Ordner prüfen, und ob ein anderes Programm die Datei offen hält</translation>
    </message>
    <message>
        <source>cannot run it ({0})</source>
        <translation>kann es nicht ausführen ({0})</translation>
    </message>
    <message>
        <source>cast shadows</source>
        <translation>Schlagschatten</translation>
    </message>
    <message>
        <source>certificate</source>
        <translation>Nachweis</translation>
    </message>
    <message>
        <source>check the mission</source>
        <translation>die Mission prüfen</translation>
    </message>
    <message>
        <source>check:    {0} of {1} rules kept, {2}</source>
        <translation>Prüfung:  {0} von {1} Regeln eingehalten, {2}</translation>
    </message>
    <message>
        <source>checked; errors: {0}</source>
        <translation>geprüft; Fehler: {0}</translation>
    </message>
    <message>
        <source>choose viewpoints and a route</source>
        <translation>Aufnahmepunkte und Flugweg wählen</translation>
    </message>
    <message>
        <source>clearing</source>
        <translation>wird gelöscht</translation>
    </message>
    <message>
        <source>coarsest pixel</source>
        <translation>gröbstes Pixel</translation>
    </message>
    <message>
        <source>collections of areas are nested too deeply</source>
        <translation>Sammlungen von Flächen sind zu tief verschachtelt</translation>
    </message>
    <message>
        <source>colouring points</source>
        <translation>Punkte werden gefärbt</translation>
    </message>
    <message>
        <source>compared with the reference: {0}</source>
        <translation>verglichen mit der Referenz: {0}</translation>
    </message>
    <message>
        <source>comparing exposures</source>
        <translation>Belichtungen werden verglichen</translation>
    </message>
    <message>
        <source>comparing photos</source>
        <translation>Fotos werden verglichen</translation>
    </message>
    <message>
        <source>comparing settings</source>
        <translation>Einstellungen werden verglichen</translation>
    </message>
    <message>
        <source>connect; a simulation needs no aircraft</source>
        <translation>verbinden; eine Simulation braucht kein Fluggerät</translation>
    </message>
    <message>
        <source>connected</source>
        <translation>verbunden</translation>
    </message>
    <message>
        <source>continue mission, and land at home</source>
        <translation>Mission fortsetzen, und am Startplatz landen</translation>
    </message>
    <message>
        <source>control point &apos;{0}&apos; is elsewhere in {1} than other photos show it; it is not used there</source>
        <translation>Passpunkt „{0}“ liegt in {1} anderswo, als andere Fotos ihn zeigen; er wird dort nicht verwendet</translation>
    </message>
    <message>
        <source>control point &apos;{0}&apos; is in different places in {1}; it is not used</source>
        <translation>Passpunkt „{0}“ liegt in {1} an verschiedenen Stellen; er wird nicht verwendet</translation>
    </message>
    <message>
        <source>control point &apos;{0}&apos; is seen by fewer than two photos of the model; it is not used</source>
        <translation>Passpunkt &apos;{0}&apos; ist in weniger als zwei Fotos des Modells zu sehen; er wird nicht verwendet</translation>
    </message>
    <message>
        <source>control point &apos;{0}&apos; is {1} m from where the others put it; it is not used</source>
        <translation>Passpunkt „{0}“ liegt {1} m von da, wo die anderen ihn hinlegen; er wird nicht verwendet</translation>
    </message>
    <message>
        <source>control points are off by {0} m in the middle, {1} m at most</source>
        <translation>die Passpunkte liegen im Mittel um {0} m daneben, höchstens um {1} m</translation>
    </message>
    <message>
        <source>cost</source>
        <translation>Kosten</translation>
    </message>
    <message>
        <source>coverage of all plans: {0} degree sections, {1} m minimum distance, occlusion {2}</source>
        <translation>Abdeckung aller Pläne: Sektoren zu {0} Grad, {1} m Mindestabstand, Verdeckung {2}</translation>
    </message>
    <message>
        <source>coverage, {0} % percentile</source>
        <translation>Abdeckung, {0}-%-Perzentil</translation>
    </message>
    <message>
        <source>coverage: {0} sections where {1} were planned{2}, {3} in all</source>
        <translation>Abdeckung: {0} Sektoren, wo {1} geplant waren{2}, {3} insgesamt</translation>
    </message>
    <message>
        <source>covered</source>
        <translation>gedeckt</translation>
    </message>
    <message>
        <source>covered at least {0} times</source>
        <translation>mindestens {0}-mal abgedeckt</translation>
    </message>
    <message>
        <source>covered before {0}, together {1} sections</source>
        <translation>vorher abgedeckt {0}, zusammen {1} Sektoren</translation>
    </message>
    <message>
        <source>cut out the part around the site, or take the file of one country</source>
        <translation>den Teil um den Standort ausschneiden oder die Datei eines einzelnen Landes nehmen</translation>
    </message>
    <message>
        <source>deciding on effects</source>
        <translation>über Effekte wird entschieden</translation>
    </message>
    <message>
        <source>dense depth</source>
        <translation>dichte Tiefen</translation>
    </message>
    <message>
        <source>distance</source>
        <translation>Strecke</translation>
    </message>
    <message>
        <source>distance of aircraft in the air at the same time</source>
        <translation>Abstand von Fluggeräten, die zugleich in der Luft sind</translation>
    </message>
    <message>
        <source>distortion: {0} folds the picture or bends it too far: a place in it belongs to no one direction; expected a lens that can be undistorted up to its corners (k1, k2, p1, p2, k3 for lengths in units of the focal length)</source>
        <translation>distortion: {0} faltet das Bild oder biegt es zu weit: eine Stelle darin gehört zu keiner eindeutigen Richtung; erwartet wird ein Objektiv, das bis in die Ecken zu entzerren ist (k1, k2, p1, p2, k3 für Längen in Einheiten der Brennweite)</translation>
    </message>
    <message>
        <source>does not say what its heights are above ({0} has no heights); say it with --vertical: ellipsoid, egm96, egm2008, or a height system such as EPSG:7837</source>
        <translation>sagt nicht, worüber ihre Höhen gezählt sind ({0} hat keine Höhen); mit --vertical angeben: ellipsoid, egm96, egm2008 oder ein Höhensystem wie EPSG:7837</translation>
    </message>
    <message>
        <source>does not say where it lies; give a GeoTIFF with its georeference</source>
        <translation>sagt nicht, wo es liegt; ein GeoTIFF mit Georeferenz angeben</translation>
    </message>
    <message>
        <source>effect</source>
        <translation>Effekt</translation>
    </message>
    <message>
        <source>effects are decided by the photos of a flight; expected at least one, got none</source>
        <translation>Effekte werden nach den Fotos eines Fluges entschieden; erwartet wird mindestens eines, gefunden keines</translation>
    </message>
    <message>
        <source>effects:
{0}</source>
        <translation>Effekte:
{0}</translation>
    </message>
    <message>
        <source>embedded, {0} x {1} rays</source>
        <translation>eingebaut, {0} x {1} Strahlen</translation>
    </message>
    <message>
        <source>ended at once with status {0} ({1})</source>
        <translation>endete sofort mit Status {0} ({1})</translation>
    </message>
    <message>
        <source>ends after {0} of its {1} points</source>
        <translation>endet nach {0} seiner {1} Punkte</translation>
    </message>
    <message>
        <source>ends at byte {0} in the middle of an entry; write the file again</source>
        <translation>endet bei Byte {0} mitten in einem Eintrag; die Datei neu schreiben</translation>
    </message>
    <message>
        <source>error {0}</source>
        <translation>Fehler {0}</translation>
    </message>
    <message>
        <source>expected &apos;KEYWORD : value&apos; or a section, found &apos;{0}&apos;</source>
        <translation>erwartet: &apos;KEYWORD : Wert&apos; oder ein Abschnitt, gefunden: &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>expected -12 to 14 hours, got {0}</source>
        <translation>erwartet wurden -12 bis 14 Stunden, gefunden {0}</translation>
    </message>
    <message>
        <source>expected -{0} to {1} degrees, got &apos;{2}&apos;</source>
        <translation>erwartet wurden -{0} bis {1} Grad, gefunden &apos;{2}&apos;</translation>
    </message>
    <message>
        <source>expected -{0} to {1} degrees, got {2}</source>
        <translation>erwartet wurden -{0} bis {1} Grad, gefunden {2}</translation>
    </message>
    <message>
        <source>expected 0, 9, 24 or 45 columns f_rest_0 and so on, found {0}</source>
        <translation>erwartet werden 0, 9, 24 oder 45 Spalten f_rest_0 und so weiter, gefunden {0}</translation>
    </message>
    <message>
        <source>expected 1 or more, got {0}</source>
        <translation>erwartet wird 1 oder mehr, angegeben {0}</translation>
    </message>
    <message>
        <source>expected 1 to 600 seconds, got {0}</source>
        <translation>erwartet wurden 1 bis 600 Sekunden, gefunden {0}</translation>
    </message>
    <message>
        <source>expected 2 or more, got 1</source>
        <translation>erwartet wird 2 oder mehr, angegeben 1</translation>
    </message>
    <message>
        <source>expected 2 to {0}, got {1}</source>
        <translation>erwartet wird 2 bis {0}, angegeben {1}</translation>
    </message>
    <message>
        <source>expected 3 values, got {0}</source>
        <translation>erwartet wurden 3 Werte, gefunden {0}</translation>
    </message>
    <message>
        <source>expected GeoJSON (features with points, lines or polygons), found something else; export it again</source>
        <translation>erwartet wird GeoJSON (Punkte, Linien oder Polygone), gefunden wurde etwas anderes; erneut exportieren</translation>
    </message>
    <message>
        <source>expected KML, found &apos;{0}&apos;; choose another file</source>
        <translation>erwartet wird KML, gefunden wurde &apos;{0}&apos;; eine andere Datei wählen</translation>
    </message>
    <message>
        <source>expected PMTiles of version 3, found version {0}; convert the map with the program pmtiles</source>
        <translation>erwartet wird PMTiles in Version 3, gefunden wurde Version {0}; die Karte mit dem Programm pmtiles umwandeln</translation>
    </message>
    <message>
        <source>expected TSP, ATSP or CVRP, found &apos;{0}&apos;</source>
        <translation>erwartet: TSP, ATSP oder CVRP, gefunden: &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>expected UTF-8, found other bytes; save it as CSV UTF-8</source>
        <translation>erwartet wird UTF-8, gefunden wurden andere Bytes; als CSV UTF-8 speichern</translation>
    </message>
    <message>
        <source>expected ZONE=REFERENCE, got &apos;{0}&apos;</source>
        <translation>erwartet wird ZONE=AKTENZEICHEN, angegeben ist &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>expected a COLMAP model (cameras and images as .bin or .txt), found {0}; models are often in sparse/0</source>
        <translation>erwartet wird ein COLMAP-Modell (Kameras und Bilder als .bin oder .txt), gefunden {0}; Modelle liegen oft in sparse/0</translation>
    </message>
    <message>
        <source>expected a GlobalId, or a name in the column &apos;name&apos;, found neither</source>
        <translation>erwartet wird eine GlobalId oder ein Name in der Spalte &apos;name&apos;, gefunden keines</translation>
    </message>
    <message>
        <source>expected a PLY file of format {0}, found &apos;{1}&apos;; save it as that</source>
        <translation>erwartet wird eine PLY-Datei vom Format {0}, gefunden &apos;{1}&apos;; so speichern</translation>
    </message>
    <message>
        <source>expected a charge from 0 to 1, got {0}</source>
        <translation>erwartet wird eine Ladung von 0 bis 1, angegeben {0}</translation>
    </message>
    <message>
        <source>expected a day before the year 9999, got {0}</source>
        <translation>erwartet wurde ein Tag vor dem Jahr 9999, gefunden {0}</translation>
    </message>
    <message>
        <source>expected a day such as 2026-06-21, got &apos;{0}&apos;</source>
        <translation>erwartet wurde ein Tag wie 2026-06-21, gefunden &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>expected a day such as 2026-11-28, got &apos;{0}&apos;</source>
        <translation>erwartet wird ein Tag wie 2026-11-28, angegeben ist &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>expected a deepest level from 0 to {0}, found {1}</source>
        <translation>erwartet wird eine tiefste Stufe von 0 bis {0}, gefunden wurde {1}</translation>
    </message>
    <message>
        <source>expected a file in the folder of the site, since it names meshes there</source>
        <translation>erwartet wird eine Datei im Ordner des Standorts, weil er dort Netze nennt</translation>
    </message>
    <message>
        <source>expected a file of {0}; choose another one</source>
        <translation>erwartet wird eine Datei aus {0}; eine andere wählen</translation>
    </message>
    <message>
        <source>expected a finite time and position</source>
        <translation>erwartet werden Zeit und Ort in endlichen Zahlen</translation>
    </message>
    <message>
        <source>expected a folder of panels files (*.json), as &apos;segment&apos; writes them; found none</source>
        <translation>erwartet wird ein Ordner mit Scheibendateien (*.json), wie &apos;segment&apos; sie schreibt; gefunden keine</translation>
    </message>
    <message>
        <source>expected a folder, found a file; name a folder for the photos</source>
        <translation>erwartet wird ein Ordner, gefunden eine Datei; einen Ordner für die Fotos nennen</translation>
    </message>
    <message>
        <source>expected a grey mask, found colours; write glass as white on black</source>
        <translation>erwartet wird eine graue Maske, gefunden wurden Farben; Glas weiß auf schwarz schreiben</translation>
    </message>
    <message>
        <source>expected a grey or colour picture of 8 bit, found {0} of shape {1}; convert it (for example to an 8-bit PNG or JPEG) first</source>
        <translation>erwartet wird ein graues oder farbiges Bild mit 8 Bit, gefunden {0} der Form {1}; es zuerst umwandeln (etwa in PNG oder JPEG mit 8 Bit)</translation>
    </message>
    <message>
        <source>expected a line with the coordinate system, then lines &apos;X Y Z column row photo name&apos;</source>
        <translation>erwartet: eine Zeile mit dem Koordinatensystem, dann Zeilen &apos;X Y Z column row photo name&apos;</translation>
    </message>
    <message>
        <source>expected a list such as a,b, got &apos;{0}&apos;</source>
        <translation>erwartet wird eine Liste wie a,b, angegeben &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>expected a lossless WebP image</source>
        <translation>erwartet wird ein verlustloses WebP-Bild</translation>
    </message>
    <message>
        <source>expected a mask for each of {0} photos, named like it; missing: {1}{2}</source>
        <translation>erwartet wird eine Maske für jedes von {0} Fotos, mit dessen Namen; es fehlen: {1}{2}</translation>
    </message>
    <message>
        <source>expected a mask for the photo &apos;{0}&apos;, found none of that name</source>
        <translation>erwartet wird eine Maske für das Foto &apos;{0}&apos;, gefunden keine dieses Namens</translation>
    </message>
    <message>
        <source>expected a name of {0}, or name the kind with --kind</source>
        <translation>erwartet wird ein Name aus {0}, oder die Art mit --kind nennen</translation>
    </message>
    <message>
        <source>expected a name that ends in .html; a PDF is made from the window (Mission, Flight brief) or by printing the page in a browser</source>
        <translation>erwartet wird ein Name mit der Endung .html; ein PDF macht das Fenster (Mission, Flugblatt), oder der Druck der Seite im Browser</translation>
    </message>
    <message>
        <source>expected a number above 0, got &apos;{0}&apos;</source>
        <translation>erwartet wird eine Zahl über 0, angegeben &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>expected a number, got &apos;{0}&apos;</source>
        <translation>erwartet wird eine Zahl, angegeben &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>expected a number{0}, got &apos;{1}&apos;</source>
        <translation>erwartet wird eine Zahl{0}, gefunden &apos;{1}&apos;</translation>
    </message>
    <message>
        <source>expected a path relative to the site file, got an empty text</source>
        <translation>erwartet wird ein Pfad relativ zur Standortdatei, angegeben ist ein leerer Text</translation>
    </message>
    <message>
        <source>expected a picture and a focal length above 0, got {0} x {1} and {2}</source>
        <translation>erwartet werden ein Bild und eine Brennweite über 0, gefunden {0} x {1} und {2}</translation>
    </message>
    <message>
        <source>expected a plan or a DJI mission (.kmz); remote controllers of DJI take nothing else</source>
        <translation>erwartet wurde ein Plan oder eine DJI-Mission (.kmz); DJI-Fernsteuerungen nehmen nichts anderes</translation>
    </message>
    <message>
        <source>expected a positive number of millimetres, got {0}</source>
        <translation>erwartet wird eine positive Zahl von Millimetern, angegeben {0}</translation>
    </message>
    <message>
        <source>expected a positive number of seconds, got {0}</source>
        <translation>erwartet wird eine positive Zahl von Sekunden, angegeben {0}</translation>
    </message>
    <message>
        <source>expected a setting and its values, such as n_splats=4000,8000</source>
        <translation>erwartet wird eine Einstellung mit ihren Werten, etwa n_splats=4000,8000</translation>
    </message>
    <message>
        <source>expected a site file, or a plan file and its site file, got {0} files</source>
        <translation>erwartet wurde eine Standortdatei, oder eine Plandatei und ihre Standortdatei, gefunden {0} Dateien</translation>
    </message>
    <message>
        <source>expected a start with its aircraft, or neither</source>
        <translation>ein Start mit seinem Fluggerät wird erwartet, oder keins von beiden</translation>
    </message>
    <message>
        <source>expected a table in UTF-8 with the columns {0}</source>
        <translation>erwartet wurde eine Tabelle in UTF-8 mit den Spalten {0}</translation>
    </message>
    <message>
        <source>expected a table of tilts, or --remove, and not both</source>
        <translation>erwartet wurde eine Tabelle von Neigungen oder --remove, nicht beides</translation>
    </message>
    <message>
        <source>expected a table with commas ({0})</source>
        <translation>erwartet wurde eine Tabelle mit Kommas ({0})</translation>
    </message>
    <message>
        <source>expected a time of day such as 08:30, got &apos;{0}&apos;</source>
        <translation>erwartet wurde eine Uhrzeit wie 08:30, gefunden &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>expected a time such as 2026-06-21T10:30, got &apos;{0}&apos;</source>
        <translation>erwartet wird eine Zeit wie 2026-06-21T10:30, angegeben &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>expected a time zone such as Europe/Berlin, got &apos;{0}&apos;</source>
        <translation>erwartet wurde eine Zeitzone wie Europe/Berlin, gefunden &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>expected a value, found none</source>
        <translation>erwartet wird ein Wert, gefunden keiner</translation>
    </message>
    <message>
        <source>expected a whole number of 1 or more, got &apos;{0}&apos;</source>
        <translation>erwartet wird eine ganze Zahl ab 1, angegeben &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>expected a whole number, found &apos;{0}&apos;</source>
        <translation>erwartet: eine ganze Zahl, gefunden: &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>expected a whole number, found {0}</source>
        <translation>erwartet: eine ganze Zahl, gefunden: {0}</translation>
    </message>
    <message>
        <source>expected a whole number, got &apos;{0}&apos;</source>
        <translation>erwartet wird eine ganze Zahl, gefunden &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>expected an address such as https://tile.example.org/{0}, found &apos;{1}&apos;</source>
        <translation>erwartet wird eine Adresse wie https://tile.example.org/{0}, gefunden wurde &apos;{1}&apos;</translation>
    </message>
    <message>
        <source>expected an earlier time than --until {0}, got {1}</source>
        <translation>erwartet wurde eine Zeit vor --until {0}, gefunden {1}</translation>
    </message>
    <message>
        <source>expected an easting of 100000 to 900000 m and a northing of at most 10000000 m, found {0} and {1}</source>
        <translation>erwartet wird ein Ostwert von 100000 bis 900000 m und ein Nordwert bis 10000000 m, gefunden wurde {0} und {1}</translation>
    </message>
    <message>
        <source>expected an index image for each photo; &apos;{0}&apos; has none</source>
        <translation>erwartet wird ein Indexbild für jedes Foto; &apos;{0}&apos; hat keines</translation>
    </message>
    <message>
        <source>expected an object of the model, got &apos;{0}&apos;</source>
        <translation>erwartet wird ein Objekt des Modells, gefunden &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>expected an object with files, found something else; name a new folder</source>
        <translation>erwartet wird ein Objekt mit Dateien, gefunden etwas anderes; einen neuen Ordner nennen</translation>
    </message>
    <message>
        <source>expected annotated photos ({0}) in this folder, found none</source>
        <translation>erwartet werden annotierte Fotos ({0}) in diesem Ordner, gefunden keine</translation>
    </message>
    <message>
        <source>expected annotations in COCO&apos;s form, found {0}</source>
        <translation>erwartet werden Annotationen in der Form von COCO, gefunden {0}</translation>
    </message>
    <message>
        <source>expected as many digits of easting as of northing, up to 5 each, found &apos;{0}&apos;</source>
        <translation>erwartet werden so viele Ziffern für Ost wie für Nord, bis je 5, gefunden wurde &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>expected at least 2 x 2 and at most {0} nodes, got {1} x {2}</source>
        <translation>erwartet mindestens 2 x 2 und höchstens {0} Knoten, gefunden {1} x {2}</translation>
    </message>
    <message>
        <source>expected at least one argument</source>
        <translation>erwartet wird mindestens ein Wert</translation>
    </message>
    <message>
        <source>expected at least one battery</source>
        <translation>mindestens ein Akku wird erwartet</translation>
    </message>
    <message>
        <source>expected at least one depot</source>
        <translation>mindestens ein Depot wird erwartet</translation>
    </message>
    <message>
        <source>expected at most one argument</source>
        <translation>erwartet wird höchstens ein Wert</translation>
    </message>
    <message>
        <source>expected auto, none, all, or NAME=on, off or auto; names are {0}</source>
        <translation>erwartet wird auto, none, all oder NAME=on, off oder auto; Namen sind {0}</translation>
    </message>
    <message>
        <source>expected columns x0, y0, x1, y1 of numbers, found {0}</source>
        <translation>erwartet werden Spalten x0, y0, x1, y1 mit Zahlen, gefunden {0}</translation>
    </message>
    <message>
        <source>expected coordinates as lon,lat in KML, found &apos;{0}&apos;</source>
        <translation>erwartet werden Koordinaten als Länge,Breite in KML, gefunden wurde &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>expected distinct point numbers, {0} occurs twice</source>
        <translation>erwartet: lauter verschiedene Punktnummern, {0} kommt zweimal vor</translation>
    </message>
    <message>
        <source>expected each file once, &apos;{0}&apos; occurs twice</source>
        <translation>erwartet wird jede Datei einmal, &apos;{0}&apos; kommt zweimal vor</translation>
    </message>
    <message>
        <source>expected files of heights, or --remove, and not both</source>
        <translation>erwartet Dateien mit Höhen oder --remove, nicht beides</translation>
    </message>
    <message>
        <source>expected finite local metres, got {0}</source>
        <translation>erwartet endliche lokale Meter, gefunden {0}</translation>
    </message>
    <message>
        <source>expected finite numbers, at most {0}</source>
        <translation>erwartet: endliche Zahlen, höchstens {0}</translation>
    </message>
    <message>
        <source>expected finite numbers, found &apos;{0}&apos;</source>
        <translation>erwartet werden endliche Zahlen, gefunden &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>expected fx_px, or focal_length_mm and sensor_width_mm, beside image_width_px and image_height_px</source>
        <translation>erwartet: fx_px, oder focal_length_mm und sensor_width_mm, dazu image_width_px und image_height_px</translation>
    </message>
    <message>
        <source>expected heads lin0 to lin4 for {0} features, as {1} has them</source>
        <translation>erwartet werden Köpfe lin0 bis lin4 für {0} Merkmale, wie {1} sie hat</translation>
    </message>
    <message>
        <source>expected heads such as &apos;maker&apos; or &apos;thickness [mm] (number)&apos;, found &apos;{0}&apos;; types are {1}</source>
        <translation>erwartet werden Spaltenköpfe wie &apos;maker&apos; oder &apos;thickness [mm] (number)&apos;, gefunden &apos;{0}&apos;; Typen sind {1}</translation>
    </message>
    <message>
        <source>expected heights for the same nodes in all three grids</source>
        <translation>erwartet Höhen für dieselben Knoten in allen drei Rastern</translation>
    </message>
    <message>
        <source>expected it once, or once for each of {0} --panel-grid, got {1}</source>
        <translation>erwartet wird es einmal, oder einmal für jedes von {0} --panel-grid, angegeben {1}</translation>
    </message>
    <message>
        <source>expected latitude, longitude and height such as 48.774,2.302,90, got &apos;{0}&apos;</source>
        <translation>erwartet: Breite, Länge und Höhe wie 48.774,2.302,90, gefunden: &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>expected less than max_alpha, {0}, got {1}</source>
        <translation>erwartet: weniger als max_alpha, {0}, gefunden: {1}</translation>
    </message>
    <message>
        <source>expected local heights within {0} m</source>
        <translation>erwartet lokale Höhen innerhalb von {0} m</translation>
    </message>
    <message>
        <source>expected longitudes and latitudes in degrees, found {0}, {1}; export it in WGS 84 (EPSG:4326)</source>
        <translation>erwartet werden Länge und Breite in Grad, gefunden wurde {0}, {1}; in WGS 84 (EPSG:4326) exportieren</translation>
    </message>
    <message>
        <source>expected more than 0 m, got {0}</source>
        <translation>erwartet mehr als 0 m, gefunden {0}</translation>
    </message>
    <message>
        <source>expected more than 0, got {0}</source>
        <translation>erwartet wird mehr als 0, angegeben {0}</translation>
    </message>
    <message>
        <source>expected named tensors, found {0}; name a file of weights</source>
        <translation>erwartet werden benannte Tensoren, gefunden {0}; eine Datei mit Gewichten nennen</translation>
    </message>
    <message>
        <source>expected no more than {0}, {1}, got {2}</source>
        <translation>erwartet: nicht mehr als {0}, {1}, gefunden: {2}</translation>
    </message>
    <message>
        <source>expected no negative weight, found {0}</source>
        <translation>erwartet: kein negatives Gewicht, gefunden: {0}</translation>
    </message>
    <message>
        <source>expected numbers of photos from 2 on</source>
        <translation>Anzahlen von Fotos ab 2 werden erwartet</translation>
    </message>
    <message>
        <source>expected numbers, found &apos;{0}&apos;</source>
        <translation>erwartet: Zahlen, gefunden: &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>expected objects with labelname and two x and y each, shares from 0 to 1, found: {0}</source>
        <translation>erwartet wurden Objekte (object) mit labelname und je zwei x und y, Anteile von 0 bis 1; gefunden: {0}</translation>
    </message>
    <message>
        <source>expected once, found again</source>
        <translation>einmal erwartet, noch einmal gefunden</translation>
    </message>
    <message>
        <source>expected one argument</source>
        <translation>erwartet wird ein Wert</translation>
    </message>
    <message>
        <source>expected one channel with panel numbers, found a colour image</source>
        <translation>erwartet wird ein Kanal mit Scheibennummern, gefunden ein farbiges Bild</translation>
    </message>
    <message>
        <source>expected one of {0}, found &apos;{1}&apos;</source>
        <translation>erwartet: eines von {0}, gefunden: &apos;{1}&apos;</translation>
    </message>
    <message>
        <source>expected one of {0}, got &apos;{1}&apos;</source>
        <translation>erwartet wird eines von {0}, angegeben &apos;{1}&apos;</translation>
    </message>
    <message>
        <source>expected one of {0}, or people per square kilometre, got &apos;{1}&apos;</source>
        <translation>erwartet eines von {0}, oder Menschen je Quadratkilometer, erhalten &apos;{1}&apos;</translation>
    </message>
    <message>
        <source>expected panel numbers up to {0}, got {1}</source>
        <translation>erwartet werden Scheibennummern bis {0}, gefunden {1}</translation>
    </message>
    <message>
        <source>expected pictures ({0}) in this folder, found none</source>
        <translation>erwartet werden Bilder ({0}) in diesem Ordner, gefunden keine</translation>
    </message>
    <message>
        <source>expected places such as [[0.1, 0.2], ...], got &apos;{0}&apos;</source>
        <translation>erwartet werden Stellen wie [[0.1, 0.2], ...], gefunden &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>expected point numbers, found none</source>
        <translation>erwartet: Punktnummern, gefunden: keine</translation>
    </message>
    <message>
        <source>expected the columns {0}, found &apos;{1}&apos;; export the model again with COLMAP</source>
        <translation>erwartet werden die Spalten {0}, gefunden &apos;{1}&apos;; das Modell noch einmal aus COLMAP exportieren</translation>
    </message>
    <message>
        <source>expected the first line {0}</source>
        <translation>erwartet wurde die erste Zeile {0}</translation>
    </message>
    <message>
        <source>expected the folder of a model; &apos;records FOLDER make --objects SITE&apos; makes one for records alone</source>
        <translation>erwartet wird der Ordner eines Modells; &apos;records FOLDER make --objects SITE&apos; legt einen für Einträge allein an</translation>
    </message>
    <message>
        <source>expected the ground between its bounds</source>
        <translation>erwartet den Boden zwischen seinen Schranken</translation>
    </message>
    <message>
        <source>expected the numbers of one camera, found {0}</source>
        <translation>erwartet: die Zahlen einer Kamera, gefunden: {0}</translation>
    </message>
    <message>
        <source>expected the sample project or nothing there, found something else</source>
        <translation>erwartet wurde dort das Beispielprojekt oder nichts, gefunden etwas anderes</translation>
    </message>
    <message>
        <source>expected the weights of AlexNet or VGG16 as torchvision names them; {0}</source>
        <translation>erwartet werden die Gewichte von AlexNet oder VGG16, wie torchvision sie nennt; {0}</translation>
    </message>
    <message>
        <source>expected three numbers after &apos;{0}:&apos;, found &apos;{1}&apos;</source>
        <translation>erwartet werden drei Zahlen nach &apos;{0}:&apos;, gefunden &apos;{1}&apos;</translation>
    </message>
    <message>
        <source>expected three numbers with commas between them, got &apos;{0}&apos;</source>
        <translation>erwartet werden drei Zahlen mit Kommas dazwischen, angegeben &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>expected three points with blanks between them, got &apos;{0}&apos;</source>
        <translation>erwartet werden drei Punkte mit Leerzeichen dazwischen, angegeben &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>expected tiles in PNG, JPEG, WebP or PBF, found something else (the file says {0}); export the map again</source>
        <translation>erwartet werden Kacheln in PNG, JPEG, WebP oder PBF, gefunden wurde etwas anderes (die Datei sagt {0}); die Karte erneut exportieren</translation>
    </message>
    <message>
        <source>expected tiles in PNG, JPEG, WebP or PBF, found something else; export the map again</source>
        <translation>erwartet werden Kacheln in PNG, JPEG, WebP oder PBF, gefunden wurde etwas anderes; die Karte erneut exportieren</translation>
    </message>
    <message>
        <source>expected tiles in PNG, JPEG, WebP or as vectors (MVT), found type {0}; export the map again</source>
        <translation>erwartet werden Kacheln in PNG, JPEG, WebP oder als Vektoren (MVT), gefunden wurde Typ {0}; die Karte erneut exportieren</translation>
    </message>
    <message>
        <source>expected two photos and metres such as A.JPG,B.JPG,12.5, got &apos;{0}&apos;</source>
        <translation>erwartet: zwei Fotos und Meter wie A.JPG,B.JPG,12.5, gefunden: &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>expected two viewpoints or more, got {0}</source>
        <translation>erwartet werden zwei oder mehr Aufnahmepunkte, gefunden {0}</translation>
    </message>
    <message>
        <source>expected whole numbers such as 32,128,0, got &apos;{0}&apos;</source>
        <translation>erwartet werden ganze Zahlen wie 32,128,0, angegeben &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>expected windows painted red (255, 0, 0), found none</source>
        <translation>erwartet werden rot gemalte Fenster (255, 0, 0), gefunden keine</translation>
    </message>
    <message>
        <source>expected yes or no, got &apos;{0}&apos;</source>
        <translation>erwartet wird ja oder nein (yes, no), gefunden &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>expected {0} cells parted by &apos;{1}&apos;, found {2}</source>
        <translation>erwartet werden {0} Zellen mit &apos;{1}&apos; dazwischen, gefunden {2}</translation>
    </message>
    <message>
        <source>expected {0} numbers ({1} of {2} points), found {3}</source>
        <translation>erwartet: {0} Zahlen ({1} von {2} Punkten), gefunden: {3}</translation>
    </message>
    <message>
        <source>expected {0} numbers for {1}, got {2}</source>
        <translation>erwartet werden {0} Zahlen für {1}, gefunden {2}</translation>
    </message>
    <message>
        <source>expected {0} of PyPI, version 0.1.0, or its file {1}; found: {2}</source>
        <translation>erwartet wurde {0} von PyPI, Version 0.1.0, oder die Datei {1} daraus; gefunden: {2}</translation>
    </message>
    <message>
        <source>expected {0} once each behind the server&apos;s name, found &apos;{1}&apos;</source>
        <translation>erwartet wird je einmal {0} hinter dem Namen des Servers, gefunden wurde &apos;{1}&apos;</translation>
    </message>
    <message>
        <source>expected {0} or more photos, or 0, got {1}</source>
        <translation>erwartet werden {0} oder mehr Fotos, oder 0, angegeben {1}</translation>
    </message>
    <message>
        <source>expected {0} or more, got {1}</source>
        <translation>erwartet wird {0} oder mehr, angegeben {1}</translation>
    </message>
    <message>
        <source>expected {0} to {1} pixels, got {2}</source>
        <translation>erwartet werden {0} bis {1} Pixel, angegeben {2}</translation>
    </message>
    <message>
        <source>expected {0} to {1}, found {2}</source>
        <translation>erwartet: {0} bis {1}, gefunden: {2}</translation>
    </message>
    <message>
        <source>expected {0} to {1}, got {2}</source>
        <translation>erwartet wird {0} bis {1}, angegeben {2}</translation>
    </message>
    <message>
        <source>expected {0} x {1} numbers ({2}), found {3}</source>
        <translation>erwartet: {0} x {1} Zahlen ({2}), gefunden: {3}</translation>
    </message>
    <message>
        <source>expected {0}, found an archive; unpack it first</source>
        <translation>erwartet wird {0}, gefunden wurde ein Archiv; zuerst entpacken</translation>
    </message>
    <message>
        <source>expected {0}, found something else</source>
        <translation>erwartet wird {0}, gefunden wurde etwas anderes</translation>
    </message>
    <message>
        <source>expected {0}, got &apos;{1}&apos;</source>
        <translation>erwartet wird {0}, gefunden &apos;{1}&apos;</translation>
    </message>
    <message>
        <source>exporting</source>
        <translation>wird exportiert</translation>
    </message>
    <message>
        <source>exposure of each photo</source>
        <translation>Belichtung jedes Fotos</translation>
    </message>
    <message>
        <source>facade &apos;{0}&apos;</source>
        <translation>Fassade &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>facade &apos;{0}&apos; (heading {1})</source>
        <translation>Fassade &apos;{0}&apos; (Richtung {1})</translation>
    </message>
    <message>
        <source>facade &apos;{0}&apos; (looks down)</source>
        <translation>Fassade &apos;{0}&apos; (blickt nach unten)</translation>
    </message>
    <message>
        <source>facade &apos;{0}&apos; (looks up)</source>
        <translation>Fassade &apos;{0}&apos; (blickt nach oben)</translation>
    </message>
    <message>
        <source>facade {0}, of what can be covered</source>
        <translation>Fassade {0}, vom Erreichbaren</translation>
    </message>
    <message>
        <source>fall from level flight</source>
        <translation>Fall aus dem Horizontalflug</translation>
    </message>
    <message>
        <source>fall without drag</source>
        <translation>Fall ohne Luftwiderstand</translation>
    </message>
    <message>
        <source>fastest climb</source>
        <translation>schnellstes Steigen</translation>
    </message>
    <message>
        <source>fetching the log</source>
        <translation>Log holen</translation>
    </message>
    <message>
        <source>fewer than {0} per square kilometre, {1} in the whole area</source>
        <translation>weniger als {0} je Quadratkilometer, {1} im ganzen Gebiet</translation>
    </message>
    <message>
        <source>files overlap, and their heights differ by up to {0} m: the higher counts below flights, the first for home</source>
        <translation>Dateien überlappen sich, und ihre Höhen unterscheiden sich um bis zu {0} m: unter Flügen zählt die höhere, für den Startplatz die erste</translation>
    </message>
    <message>
        <source>final ground risk class</source>
        <translation>endgültige Bodenrisikoklasse</translation>
    </message>
    <message>
        <source>find the panels in them</source>
        <translation>die Scheiben darin suchen</translation>
    </message>
    <message>
        <source>finding the ground</source>
        <translation>Boden wird gesucht</translation>
    </message>
    <message>
        <source>finding walls</source>
        <translation>Wände werden gesucht</translation>
    </message>
    <message>
        <source>finding what stands on the ground</source>
        <translation>suche, was auf dem Boden steht</translation>
    </message>
    <message>
        <source>findings: {0}</source>
        <translation>Befunde: {0}</translation>
    </message>
    <message>
        <source>finest pixel</source>
        <translation>feinstes Pixel</translation>
    </message>
    <message>
        <source>finest pixel on the worst panel</source>
        <translation>feinstes Pixel der schlechtesten Scheibe</translation>
    </message>
    <message>
        <source>first</source>
        <translation>erste</translation>
    </message>
    <message>
        <source>flight geography</source>
        <translation>Fluggeographie</translation>
    </message>
    <message>
        <source>flight geography up to {0} m above ground, contingency volume {1} m to each side and up to {2} m, ground-risk buffer {3} m beyond</source>
        <translation>Fluggeographie bis {0} m über Grund, Notfallvolumen {1} m zu jeder Seite und bis {2} m, Bodenrisikopuffer {3} m darüber hinaus</translation>
    </message>
    <message>
        <source>flight geography, to each side of the paths</source>
        <translation>Fluggeographie, zu jeder Seite der Pfade</translation>
    </message>
    <message>
        <source>flight levels count as low as 930 hPa and -50 degrees bring them</source>
        <translation>Flugflächen zählen so tief, wie 930 hPa und -50 Grad sie bringen</translation>
    </message>
    <message>
        <source>flight:   {0} ({1}, {2} s)</source>
        <translation>Flug:     {0} ({1}, {2} s)</translation>
    </message>
    <message>
        <source>flight:   {0} ({1}, {2})</source>
        <translation>Flug:     {0} ({1}, {2})</translation>
    </message>
    <message>
        <source>flights prohibited</source>
        <translation>Flüge verboten</translation>
    </message>
    <message>
        <source>flights under conditions</source>
        <translation>Flüge unter Bedingungen</translation>
    </message>
    <message>
        <source>flights with an authorisation only</source>
        <translation>Flüge nur mit Genehmigung</translation>
    </message>
    <message>
        <source>flown</source>
        <translation>geflogen</translation>
    </message>
    <message>
        <source>flown before the pilot acts</source>
        <translation>geflogen, bevor der Pilot handelt</translation>
    </message>
    <message>
        <source>fly it, first in simulation; or export it for your aircraft</source>
        <translation>fliegen, zuerst simuliert; oder für Ihr Fluggerät exportieren</translation>
    </message>
    <message>
        <source>fly-aways</source>
        <translation>Ausreißer</translation>
    </message>
    <message>
        <source>formula</source>
        <translation>Formel</translation>
    </message>
    <message>
        <source>formulas and tables of both were taken from public implementations that agree, and give the distances that German authorities publish (STS-BOS 1.0, tables 1 and 2); compare them with the documents</source>
        <translation>Formeln und Tabellen beider stammen aus öffentlichen Programmen, die übereinstimmen, und ergeben die Abstände, die deutsche Behörden veröffentlichen (STS-BOS 1.0, Tabellen 1 und 2); vergleichen Sie sie mit den Dokumenten</translation>
    </message>
    <message>
        <source>full speed over the ground</source>
        <translation>volle Geschwindigkeit über Grund</translation>
    </message>
    <message>
        <source>full speed through the air</source>
        <translation>volle Geschwindigkeit durch die Luft</translation>
    </message>
    <message>
        <source>fusing views: expected at least one rectified view, found none</source>
        <translation>Ansichten verbinden: erwartet wird mindestens eine entzerrte Ansicht, gefunden keine</translation>
    </message>
    <message>
        <source>fusing views: expected rectified views of one size with a mask each, found sizes {0}; rectify them all onto the same window of the facade</source>
        <translation>Ansichten verbinden: erwartet werden entzerrte Ansichten einer Größe mit je einer Maske, gefunden Größen {0}; alle auf denselben Ausschnitt der Fassade entzerren</translation>
    </message>
    <message>
        <source>give and withdraw want the url of a link; set, status and forget want none</source>
        <translation>give und withdraw brauchen die URL eines Links; set, status und forget keine</translation>
    </message>
    <message>
        <source>giving the scene to the cluster</source>
        <translation>die Szene geht an den Cluster</translation>
    </message>
    <message>
        <source>glass mirrors the sun into {0} of {1} photos with take-off at {2}</source>
        <translation>mit Start um {2} spiegelt Glas die Sonne in {0} von {1} Fotos</translation>
    </message>
    <message>
        <source>ground risk class: not known</source>
        <translation>Bodenrisikoklasse: nicht bekannt</translation>
    </message>
    <message>
        <source>ground risk class: {0} intrinsic, {1} final</source>
        <translation>Bodenrisikoklasse: {0} intrinsisch, {1} endgültig</translation>
    </message>
    <message>
        <source>ground-risk buffer</source>
        <translation>Bodenrisikopuffer</translation>
    </message>
    <message>
        <source>ground-risk buffer, 1:1</source>
        <translation>Bodenrisikopuffer, 1:1</translation>
    </message>
    <message>
        <source>ground-risk buffer, to each side</source>
        <translation>Bodenrisikopuffer, zu jeder Seite</translation>
    </message>
    <message>
        <source>has changed since it was added on {0}; look at it, and add it again</source>
        <translation>hat sich geändert, seit sie am {0} hinzugefügt wurde; ansehen und erneut hinzufügen</translation>
    </message>
    <message>
        <source>has changed while it was read</source>
        <translation>hat sich beim Lesen geändert</translation>
    </message>
    <message>
        <source>has more than {0} points; cut out the part that is wanted, or simplify it</source>
        <translation>hat mehr als {0} Punkte; den gewünschten Teil ausschneiden oder vereinfachen</translation>
    </message>
    <message>
        <source>has no &apos;{0}&apos;, so these are points and not splats</source>
        <translation>hat kein &apos;{0}&apos;, das sind also Punkte und keine Splats</translation>
    </message>
    <message>
        <source>has no heights below the airspace of the site, which lies at {0}, {1} (tile {2}); give files that cover it</source>
        <translation>hat keine Höhen unter dem Luftraum des Standorts, der bei {0}, {1} liegt (Kachel {2}); Dateien angeben, die ihn abdecken</translation>
    </message>
    <message>
        <source>has no panels, and {0} learns what panels mirror; train plain splats instead, or find its panels first</source>
        <translation>hat keine Scheiben, und {0} lernt, was Scheiben spiegeln; trainieren Sie stattdessen einfache Splats, oder suchen Sie zuerst seine Scheiben</translation>
    </message>
    <message>
        <source>has no photo &apos;{0}&apos;, which is to be scored; name photos of its views</source>
        <translation>hat kein Foto &apos;{0}&apos;, das bewertet werden soll; Fotos seiner Ansichten nennen</translation>
    </message>
    <message>
        <source>has no photo &apos;{0}&apos;, which is to be scored; score --views all</source>
        <translation>hat kein Foto &apos;{0}&apos;, das bewertet werden soll; mit score --views all bewerten</translation>
    </message>
    <message>
        <source>has no routes of DJI Fly (expected the folder {0}); make one route in DJI Fly and save it, then connect the remote controller again</source>
        <translation>hat keine Routen von DJI Fly (erwartet wurde der Ordner {0}); legen Sie in DJI Fly eine Route an und speichern Sie sie, dann schließen Sie die Fernsteuerung erneut an</translation>
    </message>
    <message>
        <source>has no splat within {0} m of the panels of {1}; are both in one frame?</source>
        <translation>hat keinen Splat bis {0} m vor den Scheiben von {1}; sind beide in einem Bezugssystem?</translation>
    </message>
    <message>
        <source>has none of the views that the model did not learn from; leave --held-out out</source>
        <translation>hat keine der Ansichten, aus denen das Modell nicht lernte; --held-out weglassen</translation>
    </message>
    <message>
        <source>has not been read</source>
        <translation>wurde nicht gelesen</translation>
    </message>
    <message>
        <source>has only views that are held out for scoring; name photos with more views</source>
        <translation>hat nur Ansichten, die zum Bewerten zurückgehalten sind; Fotos mit mehr Ansichten nennen</translation>
    </message>
    <message>
        <source>has splats on panel {0}, and {1} has {2} panels; name a file of the same site</source>
        <translation>hat Splats auf Scheibe {0}, und {1} hat {2} Scheiben; eine Datei desselben Standorts nennen</translation>
    </message>
    <message>
        <source>has {0} MB free, the files need {1} MB; delete something there</source>
        <translation>hat {0} MB frei, die Dateien brauchen {1} MB; löschen Sie dort etwas</translation>
    </message>
    <message>
        <source>has {0} bands, as pictures have; expected one band of heights</source>
        <translation>hat {0} Kanäle wie ein Bild; erwartet einen Kanal mit Höhen</translation>
    </message>
    <message>
        <source>has {0} bytes; a tile of SRTM has {1} or {2}; copy it again</source>
        <translation>hat {0} Bytes; eine SRTM-Kachel hat {1} oder {2}; noch einmal kopieren</translation>
    </message>
    <message>
        <source>heading</source>
        <translation>Richtung</translation>
    </message>
    <message>
        <source>healthy</source>
        <translation>in Ordnung</translation>
    </message>
    <message>
        <source>heights above ground count from the site&apos;s ground: are {0} m its height all around?</source>
        <translation>Höhen über Grund zählen ab dem Boden des Standorts: ist er ringsum {0} m hoch?</translation>
    </message>
    <message>
        <source>heights above the ground count from level ground: {0}</source>
        <translation>Höhen über Grund zählen vom ebenen Boden: {0}</translation>
    </message>
    <message>
        <source>heights above the ground count from the terrain: {0}</source>
        <translation>Höhen über Grund zählen vom Gelände: {0}</translation>
    </message>
    <message>
        <source>heights are counted from {0}; counted from {1} they would be {2} m</source>
        <translation>Höhen zählen ab {0}; ab {1} gezählt wären sie {2} m</translation>
    </message>
    <message>
        <source>heights count from the lowest ground in the buffer, as if all of it lay as low</source>
        <translation>Höhen zählen ab dem tiefsten Boden im Puffer, als läge er überall so tief</translation>
    </message>
    <message>
        <source>highest at {0} with {1} degrees</source>
        <translation>am höchsten um {0} mit {1} Grad</translation>
    </message>
    <message>
        <source>highest point of paths and return, above ground</source>
        <translation>höchster Punkt von Pfaden und Rückkehr, über Grund</translation>
    </message>
    <message>
        <source>holds a COLMAP model already ({0}); name an empty folder</source>
        <translation>enthält schon ein COLMAP-Modell ({0}); einen leeren Ordner nennen</translation>
    </message>
    <message>
        <source>holds no position of the aircraft; a log of the whole flight with GNSS reception is needed</source>
        <translation>enthält keinen Ort des Fluggeräts; nötig ist ein Log des ganzen Fluges mit GNSS-Empfang</translation>
    </message>
    <message>
        <source>holds no splats</source>
        <translation>enthält keine Splats</translation>
    </message>
    <message>
        <source>holds none of {0}</source>
        <translation>enthält keine von {0}</translation>
    </message>
    <message>
        <source>holds numbers that are not finite, among them {0} of splats</source>
        <translation>enthält Zahlen, die nicht endlich sind, darunter {0} von Splats</translation>
    </message>
    <message>
        <source>holds numbers that are not finite; get the files again</source>
        <translation>enthält Zahlen, die nicht endlich sind; die Dateien neu holen</translation>
    </message>
    <message>
        <source>holds photos of another run: {0} is {1} there, and {2} was asked for; ask for the same again to go on with it, or name a new folder</source>
        <translation>enthält Fotos eines anderen Laufs: {0} ist dort {1}, und verlangt wurde {2}; dasselbe noch einmal verlangen, um weiterzumachen, oder einen neuen Ordner nennen</translation>
    </message>
    <message>
        <source>holds sizes or panels that cannot be; the file is damaged</source>
        <translation>enthält Größen oder Scheiben, die nicht sein können; die Datei ist beschädigt</translation>
    </message>
    <message>
        <source>holds values of the type {0}, as shaded pictures do; expected heights as 16 or 32 bit</source>
        <translation>enthält Werte vom Typ {0} wie eine Schummerung; erwartet Höhen mit 16 oder 32 Bit</translation>
    </message>
    <message>
        <source>holds {0} {1} twice, by id or by name</source>
        <translation>enthält {0} {1} zweimal, nach Nummer oder Name</translation>
    </message>
    <message>
        <source>home lies {0} m above the terrain; move it where that is not meant</source>
        <translation>der Startplatz liegt {0} m über dem Gelände; verschieben, wenn das nicht gemeint ist</translation>
    </message>
    <message>
        <source>home was put on the terrain, {0} m from where it was</source>
        <translation>der Startplatz wurde auf das Gelände gesetzt, {0} m von seinem alten Ort</translation>
    </message>
    <message>
        <source>home {0:m} lies inside the geo-zone &apos;{1}&apos; ({2}); move it outside, or state your authorisation (--permit)</source>
        <translation>der Startplatz {0:m} liegt in der Geozone &apos;{1}&apos; ({2}); nach außen verlegen oder die Genehmigung angeben (--permit)</translation>
    </message>
    <message>
        <source>home {0:m} stands where the terrain has no heights; move home, or attach terrain that covers it</source>
        <translation>der Startplatz {0:m} liegt, wo das Gelände keine Höhen hat; ihn verschieben oder Gelände anhängen, das ihn abdeckt</translation>
    </message>
    <message>
        <source>how far {0} photos disagree on their lines{1}</source>
        <translation>wie weit {0} Fotos bei ihren Linien auseinanderliegen{1}</translation>
    </message>
    <message>
        <source>ignored explicit argument %r</source>
        <translation>übergangener Wert %r</translation>
    </message>
    <message>
        <source>image &apos;{0}&apos; has camera {1}, which is not in the model</source>
        <translation>Bild &apos;{0}&apos; hat die Kamera {1}, die nicht im Modell ist</translation>
    </message>
    <message>
        <source>image &apos;{0}&apos; holds a number that is not finite, or no rotation</source>
        <translation>Bild &apos;{0}&apos; enthält eine Zahl, die nicht endlich ist, oder keine Drehung</translation>
    </message>
    <message>
        <source>image &apos;{0}&apos;: a name with spaces at its ends or control characters cannot stand in COLMAP&apos;s text files; write the binary ones</source>
        <translation>Bild &apos;{0}&apos;: ein Name mit Leerzeichen am Rand oder Steuerzeichen kann nicht in COLMAPs Textdateien stehen; die binären schreiben</translation>
    </message>
    <message>
        <source>in format &apos;{0}{1}&apos; already, nothing to do</source>
        <translation>schon im Format &apos;{0}{1}&apos;, nichts zu tun</translation>
    </message>
    <message>
        <source>in shade</source>
        <translation>im Schatten</translation>
    </message>
    <message>
        <source>in the air</source>
        <translation>in der Luft</translation>
    </message>
    <message>
        <source>in the sun</source>
        <translation>in der Sonne</translation>
    </message>
    <message>
        <source>in the sun in part</source>
        <translation>zum Teil in der Sonne</translation>
    </message>
    <message>
        <source>in {0}°</source>
        <translation>in {0}°</translation>
    </message>
    <message>
        <source>inclined_lines[{0}] of a panels file leaves the facade; shorten it, or take it out</source>
        <translation>inclined_lines[{0}] einer Scheibendatei verlässt die Fassade; sie kürzen oder herausnehmen</translation>
    </message>
    <message>
        <source>individual mIoU</source>
        <translation>einzelne mIoU</translation>
    </message>
    <message>
        <source>individual mIoU, one to one</source>
        <translation>einzelne mIoU, eins zu eins</translation>
    </message>
    <message>
        <source>inspected {0}</source>
        <translation>geprüft {0}</translation>
    </message>
    <message>
        <source>instances of the file that are to be replaced stand in it in a way that is not understood</source>
        <translation>Instanzen der Datei, die zu ersetzen sind, stehen darin auf eine Weise, die nicht verstanden wird</translation>
    </message>
    <message>
        <source>intrinsic ground risk class</source>
        <translation>intrinsische Bodenrisikoklasse</translation>
    </message>
    <message>
        <source>invalid %(type)s value: %(value)r</source>
        <translation>ungültiger Wert (%(type)s): %(value)r</translation>
    </message>
    <message>
        <source>invalid choice: %(value)r (choose from %(choices)s)</source>
        <translation>ungültige Wahl: %(value)r (möglich sind %(choices)s)</translation>
    </message>
    <message>
        <source>is cut off; copy it again</source>
        <translation>ist abgeschnitten; noch einmal kopieren</translation>
    </message>
    <message>
        <source>is for --link URL; the simulation in this program has no link to listen to</source>
        <translation>ist für --link URL; die Simulation in diesem Programm hat keinen Link zum Abhören</translation>
    </message>
    <message>
        <source>is for --resume; a top-up closes what all sorties left open</source>
        <translation>ist für --resume; ein Ergänzungsflug schließt, was alle Einsätze offen ließen</translation>
    </message>
    <message>
        <source>is full; delete something there and send again</source>
        <translation>ist voll; löschen Sie dort etwas und senden Sie erneut</translation>
    </message>
    <message>
        <source>is missing: a flight file or a log, or --photos with the photos themselves</source>
        <translation>fehlt: eine Flugdatei oder ein Log, oder --photos mit den Fotos selbst</translation>
    </message>
    <message>
        <source>is no CSV ({0})</source>
        <translation>ist kein CSV ({0})</translation>
    </message>
    <message>
        <source>is no GeoTIFF; expected heights as .tif or .hgt</source>
        <translation>ist kein GeoTIFF; erwartet Höhen als .tif oder .hgt</translation>
    </message>
    <message>
        <source>is no PLY file (it does not start with &apos;ply&apos;)</source>
        <translation>ist keine PLY-Datei (sie beginnt nicht mit &apos;ply&apos;)</translation>
    </message>
    <message>
        <source>is no camera: {0}</source>
        <translation>ist keine Kamera: {0}</translation>
    </message>
    <message>
        <source>is no file; {0}</source>
        <translation>ist keine Datei; {0}</translation>
    </message>
    <message>
        <source>is not empty, and has no {0} of photos to go on with; name a new folder</source>
        <translation>ist nicht leer und hat kein {0} von Fotos, mit denen es weitergeht; einen neuen Ordner nennen</translation>
    </message>
    <message>
        <source>is not for --photos</source>
        <translation>ist nicht für --photos</translation>
    </message>
    <message>
        <source>is not for --resume, which fits one battery</source>
        <translation>ist nicht für --resume, das in einen Akku passt</translation>
    </message>
    <message>
        <source>is stored in one piece; export it as a tiled GeoTIFF</source>
        <translation>ist in einem Stück gespeichert; als gekacheltes GeoTIFF ausgeben</translation>
    </message>
    <message>
        <source>issued {0}</source>
        <translation>herausgegeben {0}</translation>
    </message>
    <message>
        <source>it answers with a page and no data: is the address right?</source>
        <translation>er antwortet mit einer Seite und ohne Daten: stimmt die Adresse?</translation>
    </message>
    <message>
        <source>it answers with status {0}</source>
        <translation>er antwortet mit Status {0}</translation>
    </message>
    <message>
        <source>it applies at some times only</source>
        <translation>sie gilt nur zu manchen Zeiten</translation>
    </message>
    <message>
        <source>it applies at some times only, and no time is planned (--at)</source>
        <translation>sie gilt nur zu manchen Zeiten, und es ist keine Zeit geplant (--at)</translation>
    </message>
    <message>
        <source>it cannot</source>
        <translation>es kann nicht</translation>
    </message>
    <message>
        <source>it cannot be reached ({0})</source>
        <translation>er ist nicht erreichbar ({0})</translation>
    </message>
    <message>
        <source>it does not answer</source>
        <translation>er antwortet nicht</translation>
    </message>
    <message>
        <source>it does not begin as one</source>
        <translation>es beginnt nicht wie eines</translation>
    </message>
    <message>
        <source>it does not know where the operator stands</source>
        <translation>es weiß nicht, wo der Betreiber steht</translation>
    </message>
    <message>
        <source>it does not rise</source>
        <translation>sie geht nicht auf</translation>
    </message>
    <message>
        <source>it does not set, {0}</source>
        <translation>sie geht nicht unter, {0}</translation>
    </message>
    <message>
        <source>it ended the stream</source>
        <translation>er hat den Strom beendet</translation>
    </message>
    <message>
        <source>it has a line for each panel</source>
        <translation>sie hat eine Zeile für jedes Panel</translation>
    </message>
    <message>
        <source>it has no operator number: enter yours in the settings</source>
        <translation>es hat keine Betreibernummer: tragen Sie Ihre in den Einstellungen ein</translation>
    </message>
    <message>
        <source>it has no position of the aircraft yet</source>
        <translation>es hat noch keine Position des Luftfahrzeugs</translation>
    </message>
    <message>
        <source>it has not heard for seconds where the operator stands: the link to it is bad</source>
        <translation>es hat seit Sekunden nicht gehört, wo der Betreiber steht: die Verbindung zu ihm ist schlecht</translation>
    </message>
    <message>
        <source>it is connected and sends nothing that is RTCM</source>
        <translation>er ist verbunden und sendet nichts, was RTCM ist</translation>
    </message>
    <message>
        <source>it is cut off</source>
        <translation>es ist abgeschnitten</translation>
    </message>
    <message>
        <source>it is larger than any log that can be read; take the card out</source>
        <translation>es ist größer als jedes lesbare Log; nehmen Sie die Karte heraus</translation>
    </message>
    <message>
        <source>it is {0} m above the terrain, and {1} m are required</source>
        <translation>es liegt {0} m über dem Gelände, verlangt sind {1} m</translation>
    </message>
    <message>
        <source>it knows no file transfer</source>
        <translation>es kennt keine Dateiübertragung</translation>
    </message>
    <message>
        <source>it knows no mountpoint of this name</source>
        <translation>er kennt keinen Mountpoint dieses Namens</translation>
    </message>
    <message>
        <source>it packs its data in a way that was not asked for</source>
        <translation>er packt seine Daten auf eine Weise, die nicht verlangt war</translation>
    </message>
    <message>
        <source>it refuses user and password</source>
        <translation>er lehnt Benutzer und Passwort ab</translation>
    </message>
    <message>
        <source>it says: {0}</source>
        <translation>es sagt: {0}</translation>
    </message>
    <message>
        <source>it was not looked for</source>
        <translation>nicht untersucht</translation>
    </message>
    <message>
        <source>it was not told what the flight is for</source>
        <translation>ihm wurde nicht gesagt, wozu der Flug dient</translation>
    </message>
    <message>
        <source>it would not land in the light</source>
        <translation>er würde nicht bei Licht landen</translation>
    </message>
    <message>
        <source>its authority</source>
        <translation>ihre Behörde</translation>
    </message>
    <message>
        <source>its checksum is never the vehicle&apos;s: the link damages it, or it is still being written</source>
        <translation>seine Prüfsumme ist nie die des Fahrzeugs: die Verbindung beschädigt es, oder es wird noch geschrieben</translation>
    </message>
    <message>
        <source>its content is no flight log; expected telemetry (.tlog), ArduPilot (.BIN, .log) or PX4 (.ulg)</source>
        <translation>sein Inhalt ist kein Fluglog; erwartet wird Telemetrie (.tlog), ArduPilot (.BIN, .log) oder PX4 (.ulg)</translation>
    </message>
    <message>
        <source>its coordinates are in the reference system {0}; export it in WGS 84 (EPSG:4326)</source>
        <translation>ihre Koordinaten sind im Referenzsystem {0}; in WGS 84 (EPSG:4326) ausgeben</translation>
    </message>
    <message>
        <source>its curvature is {0} standard deviations, which is noise</source>
        <translation>seine Krümmung ist {0} Standardabweichungen groß, also Rauschen</translation>
    </message>
    <message>
        <source>its data is not in chunks as it says</source>
        <translation>seine Daten sind nicht in Stücken, wie er sagt</translation>
    </message>
    <message>
        <source>its description is not as it was written ({0})</source>
        <translation>seine Beschreibung ist nicht, wie sie geschrieben wurde ({0})</translation>
    </message>
    <message>
        <source>its file system cannot</source>
        <translation>sein Dateisystem kann nicht</translation>
    </message>
    <message>
        <source>its first element is &apos;{0}&apos;, not &apos;vertex&apos;</source>
        <translation>sein erstes Element ist &apos;{0}&apos;, nicht &apos;vertex&apos;</translation>
    </message>
    <message>
        <source>its header does not end within {0} bytes; the file is damaged</source>
        <translation>sein Kopf endet nicht innerhalb von {0} Bytes; die Datei ist beschädigt</translation>
    </message>
    <message>
        <source>its headers have no end</source>
        <translation>seine Kopfzeilen haben kein Ende</translation>
    </message>
    <message>
        <source>its heights are in the unit &apos;{0}&apos;, which is not known here; say it with --height-unit</source>
        <translation>ihre Höhen sind in der Einheit &apos;{0}&apos;, die hier nicht bekannt ist; mit --height-unit angeben</translation>
    </message>
    <message>
        <source>its lower limit &apos;{0}&apos; lies above the upper one &apos;{1}&apos;</source>
        <translation>ihre Untergrenze &apos;{0}&apos; liegt über der Obergrenze &apos;{1}&apos;</translation>
    </message>
    <message>
        <source>its nearest zone is {0} km away; is this the file for this place?</source>
        <translation>ihre nächste Zone ist {0} km entfernt; ist das die Datei für diesen Ort?</translation>
    </message>
    <message>
        <source>its outline crosses itself, so all that it goes around counts</source>
        <translation>ihr Umriss kreuzt sich selbst, darum zählt alles, was er umläuft</translation>
    </message>
    <message>
        <source>its outline encloses nothing, so {0} m to each side of it count</source>
        <translation>ihr Umriss umschließt nichts, darum zählen {0} m zu jeder Seite</translation>
    </message>
    <message>
        <source>its outline reaches around the earth, so it counts as lying here</source>
        <translation>ihr Umriss reicht um die Erde, darum zählt sie als hier gelegen</translation>
    </message>
    <message>
        <source>its place is not known</source>
        <translation>ihr Ort ist nicht bekannt</translation>
    </message>
    <message>
        <source>its places are in several systems: {0}</source>
        <translation>ihre Orte stehen in mehreren Bezugssystemen: {0}</translation>
    </message>
    <message>
        <source>its points have the property &apos;{0}&apos; twice</source>
        <translation>seine Punkte haben die Eigenschaft &apos;{0}&apos; zweimal</translation>
    </message>
    <message>
        <source>its points have {0} properties; expected 1 to {1}</source>
        <translation>seine Punkte haben {0} Eigenschaften; erwartet werden 1 bis {1}</translation>
    </message>
    <message>
        <source>its shape is that of another airspace, which is not in the file (&apos;{0}&apos;)</source>
        <translation>ihre Form ist die eines anderen Luftraums, der nicht in der Datei steht (&apos;{0}&apos;)</translation>
    </message>
    <message>
        <source>its values are depths ({0}); expected heights</source>
        <translation>ihre Werte sind Tiefen ({0}); erwartet Höhen</translation>
    </message>
    <message>
        <source>its zones lie here only if latitude and longitude are exchanged; ask its publisher which is which</source>
        <translation>ihre Zonen liegen nur hier, wenn Breite und Länge vertauscht werden; beim Herausgeber fragen, was was ist</translation>
    </message>
    <message>
        <source>keep records of its panes, and export it for other programs</source>
        <translation>Einträge zu seinen Scheiben führen, und es für andere Programme exportieren</translation>
    </message>
    <message>
        <source>kept out of</source>
        <translation>wird gemieden</translation>
    </message>
    <message>
        <source>key kept; give it to a vehicle with &apos;signing give URL&apos;, over a cable</source>
        <translation>Schlüssel gespeichert; einem Fluggerät mit &apos;signing give URL&apos; geben, über ein Kabel</translation>
    </message>
    <message>
        <source>largest dimension</source>
        <translation>größte Abmessung</translation>
    </message>
    <message>
        <source>lay a grid of panels on a facade, or find panels in photos</source>
        <translation>ein Raster von Scheiben auf eine Fassade legen, oder Scheiben in Fotos suchen</translation>
    </message>
    <message>
        <source>light</source>
        <translation>Licht</translation>
    </message>
    <message>
        <source>light apart from the splats</source>
        <translation>Licht getrennt von den Splats</translation>
    </message>
    <message>
        <source>light on facades</source>
        <translation>Licht auf Fassaden</translation>
    </message>
    <message>
        <source>line &apos;{0}&apos; belongs to no airspace</source>
        <translation>Zeile &apos;{0}&apos; gehört zu keinem Luftraum</translation>
    </message>
    <message>
        <source>line &apos;{0}&apos; cannot be read</source>
        <translation>Zeile &apos;{0}&apos; ist nicht lesbar</translation>
    </message>
    <message>
        <source>line 1: expected a column &apos;global_id&apos; or &apos;name&apos;, found {0}</source>
        <translation>Zeile 1: erwartet wird eine Spalte &apos;global_id&apos; oder &apos;name&apos;, gefunden {0}</translation>
    </message>
    <message>
        <source>line 1: the column &apos;{0}&apos; is missing</source>
        <translation>Zeile 1: die Spalte &apos;{0}&apos; fehlt</translation>
    </message>
    <message>
        <source>line 1: the column &apos;{0}&apos; occurs twice</source>
        <translation>Zeile 1: die Spalte &apos;{0}&apos; kommt zweimal vor</translation>
    </message>
    <message>
        <source>line 1: there is no column &apos;{0}&apos;; known are {1}</source>
        <translation>Zeile 1: eine Spalte &apos;{0}&apos; gibt es nicht; bekannt sind {1}</translation>
    </message>
    <message>
        <source>line 1: {0}</source>
        <translation>Zeile 1: {0}</translation>
    </message>
    <message>
        <source>line {0} of its header is not understood: &apos;{1}&apos;</source>
        <translation>Zeile {0} des Kopfes wird nicht verstanden: &apos;{1}&apos;</translation>
    </message>
    <message>
        <source>line {0}: expected &apos;X Y Z column row photo name&apos;, found &apos;{1}&apos;</source>
        <translation>Zeile {0}: erwartet &apos;X Y Z column row photo name&apos;, gefunden &apos;{1}&apos;</translation>
    </message>
    <message>
        <source>listing logs</source>
        <translation>Logs auflisten</translation>
    </message>
    <message>
        <source>loading kernels</source>
        <translation>Rechenkerne werden geladen</translation>
    </message>
    <message>
        <source>local-search needs a symmetric instance; add --method pyvrp</source>
        <translation>local-search braucht eine symmetrische Instanz; --method pyvrp dazunehmen</translation>
    </message>
    <message>
        <source>local-search needs the same cost in both directions; add the method pyvrp</source>
        <translation>local-search braucht dieselben Kosten in beide Richtungen; das Verfahren pyvrp dazunehmen</translation>
    </message>
    <message>
        <source>log:      {0}</source>
        <translation>Log:      {0}</translation>
    </message>
    <message>
        <source>logs are fetched on the ground only, from a vehicle that is heard and disarmed</source>
        <translation>Logs werden nur am Boden geholt, von einem Fahrzeug, das zu hören und nicht scharf ist</translation>
    </message>
    <message>
        <source>longest fall with drag</source>
        <translation>längster Fall mit Luftwiderstand</translation>
    </message>
    <message>
        <source>look at it, pane by pane</source>
        <translation>es ansehen, Scheibe für Scheibe</translation>
    </message>
    <message>
        <source>look at what is wrong, and change the plan</source>
        <translation>die Fehler ansehen und den Plan ändern</translation>
    </message>
    <message>
        <source>look for panes</source>
        <translation>Scheiben suchen</translation>
    </message>
    <message>
        <source>looking at photos</source>
        <translation>Fotos werden angesehen</translation>
    </message>
    <message>
        <source>looking at the scene</source>
        <translation>die Szene wird angesehen</translation>
    </message>
    <message>
        <source>looking for heights</source>
        <translation>suche Höhen</translation>
    </message>
    <message>
        <source>looking for walls</source>
        <translation>Wände werden gesucht</translation>
    </message>
    <message>
        <source>lost</source>
        <translation>verloren</translation>
    </message>
    <message>
        <source>lowest flight {0} m above the ground{1} (take-off and landing apart)</source>
        <translation>niedrigster Flug {0} m über dem Boden{1} (ohne Start und Landung)</translation>
    </message>
    <message>
        <source>make a data set of photos first</source>
        <translation>zuerst aus Fotos einen Datensatz erstellen</translation>
    </message>
    <message>
        <source>make a site of photos alone, or open one</source>
        <translation>einen Standort aus Fotos allein erstellen, oder einen öffnen</translation>
    </message>
    <message>
        <source>make the data set that a model learns from</source>
        <translation>den Datensatz erstellen, von dem ein Modell lernt</translation>
    </message>
    <message>
        <source>map error</source>
        <translation>Kartenfehler</translation>
    </message>
    <message>
        <source>matching photos needs pycolmap, which is not installed; install it with: pip install &apos;reflight-groundstation[colmap]&apos;</source>
        <translation>Fotos miteinander zu vergleichen braucht pycolmap, das nicht installiert ist; installieren Sie es mit: pip install &apos;reflight-groundstation[colmap]&apos;</translation>
    </message>
    <message>
        <source>matt concrete with punched windows</source>
        <translation>matter Beton mit Lochfenstern</translation>
    </message>
    <message>
        <source>may not be written ({0}); is the card locked by its slider, or the device by its screen?</source>
        <translation>darf nicht beschrieben werden ({0}); ist die Karte durch ihren Schieber gesperrt oder das Gerät durch seinen Bildschirm?</translation>
    </message>
    <message>
        <source>mean</source>
        <translation>Mittel</translation>
    </message>
    <message>
        <source>measure every pre-flight rule</source>
        <translation>jede Regel vor dem Flug messen</translation>
    </message>
    <message>
        <source>measured tilts of panes</source>
        <translation>gemessene Neigungen von Scheiben</translation>
    </message>
    <message>
        <source>metering</source>
        <translation>Belichtung wird gemessen</translation>
    </message>
    <message>
        <source>method: expected {0}, got &apos;{1}&apos;</source>
        <translation>Methode: erwartet {0}, gefunden &apos;{1}&apos;</translation>
    </message>
    <message>
        <source>min</source>
        <translation>min</translation>
    </message>
    <message>
        <source>missed</source>
        <translation>übersehen</translation>
    </message>
    <message>
        <source>missions: {0}</source>
        <translation>Missionen: {0}</translation>
    </message>
    <message>
        <source>more aircraft would not land earlier, so far apart; --apart lets them fly nearer</source>
        <translation>mehr Fluggeräte würden bei diesem Abstand nicht früher landen; mit --apart dürfen sie näher fliegen</translation>
    </message>
    <message>
        <source>more than {0}</source>
        <translation>mehr als {0}</translation>
    </message>
    <message>
        <source>more than {0} and at most {1}</source>
        <translation>mehr als {0} und höchstens {1}</translation>
    </message>
    <message>
        <source>more, where it still climbs or the wind carries it</source>
        <translation>mehr, wo es noch steigt oder der Wind es trägt</translation>
    </message>
    <message>
        <source>moving the swarm</source>
        <translation>der Schwarm bewegt sich</translation>
    </message>
    <message>
        <source>name a plan or missions to send, or --list</source>
        <translation>nennen Sie einen Plan oder Missionen zum Senden, oder --list</translation>
    </message>
    <message>
        <source>name with --to where the mission goes; connected: {0}</source>
        <translation>nennen Sie mit --to, wohin die Mission soll; angeschlossen: {0}</translation>
    </message>
    <message>
        <source>name: expected the name of an object of the model, got &apos;{0}&apos;</source>
        <translation>name: erwartet wird der Name eines Objekts des Modells, gefunden &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>name: several objects have the name &apos;{0}&apos;; give the GlobalId</source>
        <translation>name: mehrere Objekte haben den Namen &apos;{0}&apos;; die GlobalId nennen</translation>
    </message>
    <message>
        <source>names a coordinate reference system that is not known here; name it with --crs</source>
        <translation>nennt ein Koordinatenreferenzsystem, das hier nicht bekannt ist; mit --crs angeben</translation>
    </message>
    <message>
        <source>names no coordinate reference system; name it with --crs</source>
        <translation>nennt kein Koordinatenreferenzsystem; mit --crs angeben</translation>
    </message>
    <message>
        <source>needs the folder of its annotated photos; name it with --data</source>
        <translation>braucht den Ordner seiner annotierten Fotos; mit --data nennen</translation>
    </message>
    <message>
        <source>network for panes</source>
        <translation>neuronales Netz für Scheiben</translation>
    </message>
    <message>
        <source>never</source>
        <translation>nie</translation>
    </message>
    <message>
        <source>never inspected</source>
        <translation>nie geprüft</translation>
    </message>
    <message>
        <source>next: {0} {1}</source>
        <translation>weiter: {0} {1}</translation>
    </message>
    <message>
        <source>no ArduPilot or PX4 is heard within {0} s; is it switched on?</source>
        <translation>innerhalb von {0} s ist kein ArduPilot oder PX4 zu hören; ist es eingeschaltet?</translation>
    </message>
    <message>
        <source>no Dask scheduler answers at {0} ({1})</source>
        <translation>kein Dask-Scheduler antwortet unter {0} ({1})</translation>
    </message>
    <message>
        <source>no building in this file has windows; {0}</source>
        <translation>kein Gebäude in dieser Datei hat Fenster; {0}</translation>
    </message>
    <message>
        <source>no card or remote controller is connected; on Windows and macOS a controller that is connected by USB has no path: use its card</source>
        <translation>keine Karte oder Fernsteuerung ist angeschlossen; unter Windows und macOS hat eine per USB angeschlossene Fernsteuerung keinen Pfad: nehmen Sie ihre Karte</translation>
    </message>
    <message>
        <source>no choice as large from the viewpoints compared is expected to bring more than {0} dB</source>
        <translation>keine ebenso große Auswahl aus den verglichenen Aufnahmeorten lässt mehr als {0} dB erwarten</translation>
    </message>
    <message>
        <source>no choice from the views that were compared closes more than {0} on these batteries</source>
        <translation>keine Auswahl aus den verglichenen Aufnahmen schließt mit diesen Akkus mehr als {0}</translation>
    </message>
    <message>
        <source>no choice of as many viewpoints from those compared covers more than {0}</source>
        <translation>keine Auswahl ebenso vieler Aufnahmepunkte aus den verglichenen deckt mehr als {0} ab</translation>
    </message>
    <message>
        <source>no errors; warnings: {0}</source>
        <translation>keine Fehler; Warnungen: {0}</translation>
    </message>
    <message>
        <source>no flight can cover more than {0}, so this is {1} % of what is possible</source>
        <translation>kein Flug kann mehr als {0} abdecken, das sind also {1} % des Möglichen</translation>
    </message>
    <message>
        <source>no flights yet; simulated ones: {0} (--simulated)</source>
        <translation>noch keine Flüge; simulierte: {0} (--simulated)</translation>
    </message>
    <message>
        <source>no geo-zones are known here; add files of your authority: &apos;site zones SITE FILE&apos;</source>
        <translation>hier sind keine Geozonen bekannt; Dateien der Behörde hinzufügen: &apos;site zones SITE FILE&apos;</translation>
    </message>
    <message>
        <source>no ground was seen: it is taken to be where the lowest points are</source>
        <translation>es war kein Boden zu sehen: er wird dort angenommen, wo die tiefsten Punkte sind</translation>
    </message>
    <message>
        <source>no method found a tour</source>
        <translation>kein Verfahren fand eine Rundtour</translation>
    </message>
    <message>
        <source>no other times of this day spoil fewer photos</source>
        <translation>keine anderen Zeiten dieses Tages verderben weniger Fotos</translation>
    </message>
    <message>
        <source>no pane has a measured tilt</source>
        <translation>keine Scheibe hat eine gemessene Neigung</translation>
    </message>
    <message>
        <source>no panels found: is the facade seen from its front, and are its frames visible?</source>
        <translation>keine Scheiben gefunden: Ist die Fassade von vorn zu sehen, und sind ihre Rahmen sichtbar?</translation>
    </message>
    <message>
        <source>no photo can be given a camera pose ({0}); {1}. Or make a coarse model of the photos, which finds their poses by itself, and take its poses</source>
        <translation>kein Foto bekommt eine Kamerapose ({0}); {1}. Oder machen Sie ein Grobmodell der Fotos, das ihre Posen selbst findet, und nehmen Sie dessen Posen</translation>
    </message>
    <message>
        <source>no photo says where and when it was taken ({0}); use the files as the camera wrote them: programs that edit, send or share photos often take that out</source>
        <translation>kein Foto sagt, wo und wann es gemacht wurde ({0}); die Dateien benutzen, wie die Kamera sie schrieb: Programme zum Bearbeiten, Senden oder Teilen nehmen das oft heraus</translation>
    </message>
    <message>
        <source>no plug-ins are installed (entry points of {0})</source>
        <translation>keine Plug-ins sind installiert (Entry Points von {0})</translation>
    </message>
    <message>
        <source>no restriction</source>
        <translation>keine Beschränkung</translation>
    </message>
    <message>
        <source>no room for it in the light of this day: fly it on another</source>
        <translation>bei Licht ist an diesem Tag kein Platz für ihn: an einem anderen fliegen</translation>
    </message>
    <message>
        <source>no single flight over the views that were compared takes less than {0} min</source>
        <translation>kein einzelner Flug über die verglichenen Aufnahmen dauert weniger als {0} min</translation>
    </message>
    <message>
        <source>no sun falls on panes</source>
        <translation>keine Sonne fällt auf Scheiben</translation>
    </message>
    <message>
        <source>no top-up was written; --all writes it all the same</source>
        <translation>kein Ergänzungsflug wurde geschrieben; --all schreibt ihn trotzdem</translation>
    </message>
    <message>
        <source>no two aircraft are in the air at the same time</source>
        <translation>keine zwei Fluggeräte sind zugleich in der Luft</translation>
    </message>
    <message>
        <source>no type</source>
        <translation>kein Typ</translation>
    </message>
    <message>
        <source>no video can be opened at {0}; it is tried again</source>
        <translation>unter {0} lässt sich kein Video öffnen; es wird wieder versucht</translation>
    </message>
    <message>
        <source>no view shows a pane</source>
        <translation>keine Ansicht zeigt eine Scheibe</translation>
    </message>
    <message>
        <source>no wall was found</source>
        <translation>keine Wand wurde gefunden</translation>
    </message>
    <message>
        <source>no wall was found: the points say too little; come closer, and take photos that overlap more</source>
        <translation>es wurde keine Wand gefunden: die Punkte sagen zu wenig; gehen Sie näher heran, und machen Sie Fotos, die sich mehr überlappen</translation>
    </message>
    <message>
        <source>no zone of these files is near the site</source>
        <translation>keine Zone dieser Dateien liegt nahe am Standort</translation>
    </message>
    <message>
        <source>no zone of {0} counts as clear: {1}</source>
        <translation>keine Zone von {0} gilt als frei: {1}</translation>
    </message>
    <message>
        <source>no zone of {0} was kept out of: {1}</source>
        <translation>keine Zone von {0} wurde gemieden: {1}</translation>
    </message>
    <message>
        <source>nobody has said where the site is, or how large: make its coarse model again with --origin, and with a distance or control points, or set its origin on the Site tab once its size is known</source>
        <translation>niemand hat gesagt, wo der Standort ist, oder wie groß: machen Sie sein Grobmodell noch einmal mit --origin und mit einer Strecke oder Passpunkten, oder setzen Sie seinen Ursprung im Reiter Standort, sobald seine Größe bekannt ist</translation>
    </message>
    <message>
        <source>nobody who is not involved (controlled ground area)</source>
        <translation>niemand Unbeteiligtes (kontrollierter Bodenbereich)</translation>
    </message>
    <message>
        <source>none</source>
        <translation>keine</translation>
    </message>
    <message>
        <source>none begins so</source>
        <translation>keine beginnt so</translation>
    </message>
    <message>
        <source>none from {0} yet</source>
        <translation>noch keine von {0}</translation>
    </message>
    <message>
        <source>none from {0}: {1}</source>
        <translation>keine von {0}: {1}</translation>
    </message>
    <message>
        <source>none of its {0} photos says where the camera looked; name the plan that was flown as well (--plan)</source>
        <translation>keines seiner {0} Fotos sagt, wohin die Kamera blickte; auch den geflogenen Plan nennen (--plan)</translation>
    </message>
    <message>
        <source>none of the photos says where it was taken; name their COLMAP model</source>
        <translation>keines der Fotos sagt, wo es aufgenommen wurde; ihr COLMAP-Modell nennen</translation>
    </message>
    <message>
        <source>none of the tiles in the folder ({0}) covers the site; it needs {1}</source>
        <translation>keine der Kacheln im Ordner ({0}) deckt den Standort ab; gebraucht wird {1}</translation>
    </message>
    <message>
        <source>none of the {0} images of the COLMAP model is a photo in {1}; are the names in the model the paths below the folder of photos?</source>
        <translation>keines der {0} Bilder des COLMAP-Modells ist ein Foto in {1}; sind die Namen im Modell die Pfade unter dem Ordner der Fotos?</translation>
    </message>
    <message>
        <source>none of the {0} objects has its GlobalId in this file</source>
        <translation>keines der {0} Objekte hat seine GlobalId in dieser Datei</translation>
    </message>
    <message>
        <source>none of the {0} views to be scored has {1} pixels that lie whole on a panel; take larger or more photos</source>
        <translation>keine der {0} zu bewertenden Ansichten hat {1} Pixel, die ganz auf einer Scheibe liegen; größere oder mehr Fotos nehmen</translation>
    </message>
    <message>
        <source>none of {0} photos has a pixel that lies whole on a panel; take larger photos (--width) or come closer</source>
        <translation>keines von {0} Fotos hat ein Pixel, das ganz auf einer Scheibe liegt; größere Fotos nehmen (--width) oder näher herangehen</translation>
    </message>
    <message>
        <source>not KML, or damaged ({0}); export it again</source>
        <translation>kein KML, oder beschädigt ({0}); erneut exportieren</translation>
    </message>
    <message>
        <source>not a GeoTIFF that can be shown ({0}); export it again</source>
        <translation>kein GeoTIFF, das gezeigt werden kann ({0}); erneut exportieren</translation>
    </message>
    <message>
        <source>not a map in PMTiles format, or damaged ({0}); choose another file, or export the map again</source>
        <translation>keine Karte im Format PMTiles, oder beschädigt ({0}); eine andere Datei wählen oder die Karte erneut exportieren</translation>
    </message>
    <message>
        <source>not allowed with argument %s</source>
        <translation>nicht zusammen mit Argument %s erlaubt</translation>
    </message>
    <message>
        <source>not assessed: {0}</source>
        <translation>nicht bewertet: {0}</translation>
    </message>
    <message>
        <source>not kept out of</source>
        <translation>wird nicht gemieden</translation>
    </message>
    <message>
        <source>not readable</source>
        <translation>nicht lesbar</translation>
    </message>
    <message>
        <source>not ready to fly: see the errors above</source>
        <translation>nicht flugbereit: siehe die Fehler oben</translation>
    </message>
    <message>
        <source>not sent, the aircraft would refuse it: {0}</source>
        <translation>nicht gesendet, das Luftfahrzeug würde es ablehnen: {0}</translation>
    </message>
    <message>
        <source>not stated how many: keep everybody out who is not involved</source>
        <translation>nicht angegeben, wie viele: halten Sie alle Unbeteiligten fern</translation>
    </message>
    <message>
        <source>not supported; expected an instance without fixed edges</source>
        <translation>nicht unterstützt; erwartet wird eine Aufgabe ohne feste Kanten</translation>
    </message>
    <message>
        <source>not written</source>
        <translation>nicht geschrieben</translation>
    </message>
    <message>
        <source>not written: there is no export into a file of this ending; name a folder, which gets a CSV table for each kind of records (any spreadsheet opens them), or a name ending in .ifc</source>
        <translation>nicht geschrieben: Es gibt keinen Export in eine Datei dieser Endung; einen Ordner nennen, der eine CSV-Tabelle für jede Art von Einträgen bekommt (jede Tabellenkalkulation öffnet sie), oder einen Namen mit der Endung .ifc</translation>
    </message>
    <message>
        <source>note: the runs shared the machine, so their times cannot be compared</source>
        <translation>Hinweis: die Läufe teilten sich den Rechner, ihre Zeiten sind also nicht vergleichbar</translation>
    </message>
    <message>
        <source>note: the state is kept in {0}; --resume goes on with it</source>
        <translation>Hinweis: der Stand bleibt in {0}; --resume macht damit weiter</translation>
    </message>
    <message>
        <source>note: {0}</source>
        <translation>Hinweis: {0}</translation>
    </message>
    <message>
        <source>nothing is missing</source>
        <translation>nichts fehlt</translation>
    </message>
    <message>
        <source>nothing says where north is: it is taken to be ahead of the first photo</source>
        <translation>nichts sagt, wo Norden ist: es wird in Blickrichtung des ersten Fotos angenommen</translation>
    </message>
    <message>
        <source>nothing says where on earth this is: give --origin before anything is flown</source>
        <translation>nichts sagt, wo auf der Erde das ist: geben Sie --origin an, bevor geflogen wird</translation>
    </message>
    <message>
        <source>nothing stands between the photos and the panels</source>
        <translation>nichts steht zwischen den Fotos und den Scheiben</translation>
    </message>
    <message>
        <source>nothing to take back</source>
        <translation>nichts zurückzunehmen</translation>
    </message>
    <message>
        <source>nothing was taken over: {0}</source>
        <translation>nichts wurde übernommen: {0}</translation>
    </message>
    <message>
        <source>nothing was tried</source>
        <translation>nichts wurde versucht</translation>
    </message>
    <message>
        <source>nothing yet</source>
        <translation>noch nichts</translation>
    </message>
    <message>
        <source>now in format &apos;{0}{1}&apos; (see project.json)</source>
        <translation>jetzt im Format &apos;{0}{1}&apos; (siehe project.json)</translation>
    </message>
    <message>
        <source>number and demand a point</source>
        <translation>Nummer und Bedarf je Punkt</translation>
    </message>
    <message>
        <source>number and {0} coordinates a point</source>
        <translation>Nummer und {0} Koordinaten je Punkt</translation>
    </message>
    <message>
        <source>number {0}</source>
        <translation>Nummer {0}</translation>
    </message>
    <message>
        <source>obstacles from the surface: {0} boxes, and {1} where it has no heights</source>
        <translation>Hindernisse aus der Oberfläche: {0} Quader, und {1}, wo sie keine Höhen hat</translation>
    </message>
    <message>
        <source>of all sections</source>
        <translation>von allen Sektoren</translation>
    </message>
    <message>
        <source>of panels or of glass</source>
        <translation>der Scheiben oder des Glases</translation>
    </message>
    <message>
        <source>of the aircraft in the plan</source>
        <translation>des Fluggeräts im Plan</translation>
    </message>
    <message>
        <source>of the plan</source>
        <translation>des Plans</translation>
    </message>
    <message>
        <source>of the points</source>
        <translation>der Punkte</translation>
    </message>
    <message>
        <source>of what can be covered</source>
        <translation>vom Erreichbaren</translation>
    </message>
    <message>
        <source>of {0} it is not known how large, heavy and fast it is; state {1}, or &apos;body&apos; in a profile of your own</source>
        <translation>von {0} ist nicht bekannt, wie groß, schwer und schnell es ist; geben Sie {1} an, oder &apos;body&apos; in einem eigenen Profil</translation>
    </message>
    <message>
        <source>off</source>
        <translation>aus</translation>
    </message>
    <message>
        <source>on</source>
        <translation>an</translation>
    </message>
    <message>
        <source>on their own kind</source>
        <translation>auf der eigenen Art</translation>
    </message>
    <message>
        <source>once more: </source>
        <translation>noch einmal: </translation>
    </message>
    <message>
        <source>one of the arguments %s is required</source>
        <translation>eines der Argumente %s ist nötig</translation>
    </message>
    <message>
        <source>open it</source>
        <translation>es öffnen</translation>
    </message>
    <message>
        <source>opened no link at {0} within {1} s</source>
        <translation>öffnete innerhalb von {1} s keinen Link unter {0}</translation>
    </message>
    <message>
        <source>operator number &apos;{0}&apos;: expected 3 capitals for the state, 13 small letters and digits, and perhaps a hyphen and 3 more, such as FIN87astrdge12k8-xyz</source>
        <translation>Betreibernummer &apos;{0}&apos;: erwartet wurden 3 Großbuchstaben für den Staat, 13 kleine Buchstaben und Ziffern und vielleicht ein Bindestrich mit 3 weiteren, etwa FIN87astrdge12k8-xyz</translation>
    </message>
    <message>
        <source>operator number &apos;{0}&apos;: its checksum is wrong; compare it with your registration, letter by letter</source>
        <translation>Betreibernummer &apos;{0}&apos;: ihre Prüfsumme ist falsch; vergleichen Sie sie Zeichen für Zeichen mit Ihrer Registrierung</translation>
    </message>
    <message>
        <source>operator number: expected 1 to {0} letters and digits, got {1}</source>
        <translation>Betreibernummer: erwartet wurden 1 bis {0} Buchstaben und Ziffern, es sind {1}</translation>
    </message>
    <message>
        <source>optimum</source>
        <translation>Optimum</translation>
    </message>
    <message>
        <source>order of sorties</source>
        <translation>Reihenfolge der Einsätze</translation>
    </message>
    <message>
        <source>origin {0}, {1}, {2} m above the ellipsoid</source>
        <translation>Ursprung {0}, {1}, {2} m über dem Ellipsoid</translation>
    </message>
    <message>
        <source>over terrain of which no heights are known</source>
        <translation>über Gelände, dessen Höhen nicht bekannt sind</translation>
    </message>
    <message>
        <source>overall IoU of glass</source>
        <translation>gesamte IoU des Glases</translation>
    </message>
    <message>
        <source>overall mIoU</source>
        <translation>gesamte mIoU</translation>
    </message>
    <message>
        <source>overexposed photos</source>
        <translation>überbelichtete Fotos</translation>
    </message>
    <message>
        <source>panel &apos;{0}&apos; stands there twice</source>
        <translation>Panel &apos;{0}&apos; steht zweimal darin</translation>
    </message>
    <message>
        <source>panels of photo &apos;{0}&apos; are given for {1} x {2} pixels, but it has {3} x {4}; find and correct them in the photo itself</source>
        <translation>Scheiben des Fotos &apos;{0}&apos; sind für {1} x {2} Pixel gegeben, es hat aber {3} x {4}; sie im Foto selbst suchen und verbessern</translation>
    </message>
    <message>
        <source>panels of photo &apos;{0}&apos; are given, which is none of the {1} photos that have a pose; name the photo&apos;s file in its field &apos;image&apos;, or take the panels file out of the folder</source>
        <translation>Scheiben des Fotos &apos;{0}&apos; sind gegeben, das keines der {1} Fotos mit einer Pose ist; die Datei des Fotos im Feld &apos;image&apos; nennen oder die Scheibendatei aus dem Ordner nehmen</translation>
    </message>
    <message>
        <source>panels: {0}</source>
        <translation>Scheiben: {0}</translation>
    </message>
    <message>
        <source>parts of the log are damaged and were skipped</source>
        <translation>Teile des Logs sind beschädigt und wurden übersprungen</translation>
    </message>
    <message>
        <source>parts that are cut off or cut out count all the same</source>
        <translation>Teile, die ab- oder ausgeschnitten werden, zählen trotzdem</translation>
    </message>
    <message>
        <source>passphrase: </source>
        <translation>Passphrase: </translation>
    </message>
    <message>
        <source>password of the caster: </source>
        <translation>Passwort des Casters: </translation>
    </message>
    <message>
        <source>people below: {0}</source>
        <translation>Menschen darunter: {0}</translation>
    </message>
    <message>
        <source>permissions of the old state of &apos;{0}&apos; have ended, state them again: {1}</source>
        <translation>Genehmigungen für den alten Stand von &apos;{0}&apos; sind beendet, erneut angeben: {1}</translation>
    </message>
    <message>
        <source>permitted by &apos;{0}&apos;</source>
        <translation>genehmigt durch &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>photo &apos;{0}&apos; is in {1} already; keep one of them</source>
        <translation>Foto &apos;{0}&apos; ist schon in {1}; eines davon behalten</translation>
    </message>
    <message>
        <source>photographing unseen views</source>
        <translation>ungesehene Ansichten werden fotografiert</translation>
    </message>
    <message>
        <source>photos</source>
        <translation>Fotos</translation>
    </message>
    <message>
        <source>photos fit the model better where what they show is {0} px elsewhere</source>
        <translation>Fotos passen besser zum Modell, wenn alles in ihnen um {0} px verschoben ist</translation>
    </message>
    <message>
        <source>photos of {0}</source>
        <translation>Fotos von {0}</translation>
    </message>
    <message>
        <source>photos read: {0}</source>
        <translation>gelesene Fotos: {0}</translation>
    </message>
    <message>
        <source>photos: {0} of {1} views</source>
        <translation>Fotos: {0} von {1} Aufnahmen</translation>
    </message>
    <message>
        <source>pitch</source>
        <translation>Neigung</translation>
    </message>
    <message>
        <source>placing photos by their receivers</source>
        <translation>Fotos werden nach ihren Empfängern gesetzt</translation>
    </message>
    <message>
        <source>plan a flight first</source>
        <translation>zuerst einen Flug planen</translation>
    </message>
    <message>
        <source>plan again, or ask {0} and state the authorisation (--permit)</source>
        <translation>neu planen oder {0} fragen und die Genehmigung angeben (--permit)</translation>
    </message>
    <message>
        <source>plan ready</source>
        <translation>Plan fertig</translation>
    </message>
    <message>
        <source>plan the flight again</source>
        <translation>den Flug neu planen</translation>
    </message>
    <message>
        <source>plan the flight as the form says</source>
        <translation>den Flug planen, wie das Formular sagt</translation>
    </message>
    <message>
        <source>plan them further apart, or one after the other</source>
        <translation>weiter auseinander oder nacheinander planen</translation>
    </message>
    <message>
        <source>plane facade of 20 x 8 panels, street, buildings opposite, trees and cars before it</source>
        <translation>ebene Fassade aus 20 x 8 Scheiben, Straße, Häuser gegenüber, Bäume und Autos davor</translation>
    </message>
    <message>
        <source>planned by</source>
        <translation>geplant von</translation>
    </message>
    <message>
        <source>planned in {0} s ({1})</source>
        <translation>geplant in {0} s ({1})</translation>
    </message>
    <message>
        <source>plans keep out of it</source>
        <translation>Pläne meiden sie</translation>
    </message>
    <message>
        <source>plans need not keep out of it</source>
        <translation>Pläne brauchen sie nicht zu meiden</translation>
    </message>
    <message>
        <source>plans:   {0}</source>
        <translation>Pläne:    {0}</translation>
    </message>
    <message>
        <source>point {0} says that {1} observations follow, more than the file holds; it is damaged or cut off: write it again</source>
        <translation>Punkt {0} sagt, dass {1} Beobachtungen folgen, mehr als die Datei enthält; sie ist beschädigt oder abgeschnitten: neu schreiben</translation>
    </message>
    <message>
        <source>pose of each photo</source>
        <translation>Pose jedes Fotos</translation>
    </message>
    <message>
        <source>position</source>
        <translation>Position</translation>
    </message>
    <message>
        <source>position hold error</source>
        <translation>Fehler beim Halten der Position</translation>
    </message>
    <message>
        <source>profile &apos;{0}&apos;</source>
        <translation>Profil &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>profile: {0}</source>
        <translation>Profil: {0}</translation>
    </message>
    <message>
        <source>project: {0}</source>
        <translation>Projekt: {0}</translation>
    </message>
    <message>
        <source>px of parallax</source>
        <translation>px Parallaxe</translation>
    </message>
    <message>
        <source>question: {0}</source>
        <translation>Frage: {0}</translation>
    </message>
    <message>
        <source>reachability</source>
        <translation>Erreichbarkeit</translation>
    </message>
    <message>
        <source>reaches beyond the end of web maps (85 degrees); cut out the part that is wanted</source>
        <translation>reicht über das Ende von Webkarten (85 Grad) hinaus; den gewünschten Teil ausschneiden</translation>
    </message>
    <message>
        <source>reaction</source>
        <translation>Reaktion</translation>
    </message>
    <message>
        <source>read back and compared, files: {0}; take the device out by the system&apos;s eject before you pull it</source>
        <translation>zurückgelesen und verglichen, Dateien: {0}; werfen Sie das Gerät aus, bevor Sie es abziehen</translation>
    </message>
    <message>
        <source>read the photos of a flight; the sample project has some</source>
        <translation>die Fotos eines Flugs lesen; das Beispielprojekt hat welche</translation>
    </message>
    <message>
        <source>read the photos of the flight</source>
        <translation>die Fotos des Flugs lesen</translation>
    </message>
    <message>
        <source>read the warnings; then fly it, first in simulation, or export it</source>
        <translation>die Warnungen lesen; dann fliegen, zuerst simuliert, oder exportieren</translation>
    </message>
    <message>
        <source>reading geo-zones</source>
        <translation>Geozonen werden gelesen</translation>
    </message>
    <message>
        <source>reading heights</source>
        <translation>lese Höhen</translation>
    </message>
    <message>
        <source>reading the IFC file</source>
        <translation>die IFC-Datei wird gelesen</translation>
    </message>
    <message>
        <source>reading the log</source>
        <translation>das Log wird gelesen</translation>
    </message>
    <message>
        <source>ready in</source>
        <translation>bereit in</translation>
    </message>
    <message>
        <source>ready to fly</source>
        <translation>flugbereit</translation>
    </message>
    <message>
        <source>ready to fly, but read {0} above</source>
        <translation>flugbereit, aber {0} oben lesen</translation>
    </message>
    <message>
        <source>ready to take off</source>
        <translation>startbereit</translation>
    </message>
    <message>
        <source>receivers are off by {0} m in the middle, {1} m at most</source>
        <translation>die Empfänger liegen im Mittel um {0} m daneben, höchstens um {1} m</translation>
    </message>
    <message>
        <source>record {0}, no sortie of the plan</source>
        <translation>Aufzeichnung {0}, kein Einsatz des Plans</translation>
    </message>
    <message>
        <source>refined poses{0}</source>
        <translation>verfeinerte Posen{0}</translation>
    </message>
    <message>
        <source>remote ID is demanded and switched off: set DID_ENABLE to 1</source>
        <translation>Remote ID ist verlangt und ausgeschaltet: setzen Sie DID_ENABLE auf 1</translation>
    </message>
    <message>
        <source>remote ID: {0}</source>
        <translation>Remote ID: {0}</translation>
    </message>
    <message>
        <source>rendered in</source>
        <translation>gerendert in</translation>
    </message>
    <message>
        <source>rendered in {0} s</source>
        <translation>gerendert in {0} s</translation>
    </message>
    <message>
        <source>rendering photos</source>
        <translation>Fotos werden berechnet</translation>
    </message>
    <message>
        <source>rendering the truth</source>
        <translation>die Wahrheit wird berechnet</translation>
    </message>
    <message>
        <source>replaces what DJI Fly has as route {0}; its name and picture in DJI Fly stay the old ones; do not save it again in DJI Fly, which would write it anew</source>
        <translation>ersetzt, was DJI Fly als Route {0} hat; Name und Bild in DJI Fly bleiben die alten; speichern Sie sie in DJI Fly nicht erneut, das würde sie neu schreiben</translation>
    </message>
    <message>
        <source>rest of sortie {0} from {1} on, {2}, {3} m, {4} min</source>
        <translation>Rest von Einsatz {0} ab {1}, {2}, {3} m, {4} min</translation>
    </message>
    <message>
        <source>route &apos;{0}&apos;: expected the beginning of one route&apos;s id, {1}</source>
        <translation>Route &apos;{0}&apos;: erwartet wurde der Anfang der Kennung einer Route, {1}</translation>
    </message>
    <message>
        <source>route {0} is named twice; each sortie needs one of its own</source>
        <translation>Route {0} ist zweimal genannt; jeder Flug braucht eine eigene</translation>
    </message>
    <message>
        <source>routes are named for DJI Fly only; {0} takes files by their names</source>
        <translation>Routen werden nur für DJI Fly genannt; {0} nimmt Dateien nach ihrem Namen</translation>
    </message>
    <message>
        <source>routing</source>
        <translation>Route</translation>
    </message>
    <message>
        <source>run</source>
        <translation>Lauf</translation>
    </message>
    <message>
        <source>running</source>
        <translation>läuft</translation>
    </message>
    <message>
        <source>running on the cluster</source>
        <translation>läuft auf dem Cluster</translation>
    </message>
    <message>
        <source>runs another version of it</source>
        <translation>führt eine andere Version davon aus</translation>
    </message>
    <message>
        <source>s a photo</source>
        <translation>s je Foto</translation>
    </message>
    <message>
        <source>samples: expected 1 to 32 along a pixel&apos;s side, or auto, got {0}</source>
        <translation>samples: erwartet werden 1 bis 32 entlang einer Pixelseite oder auto, angegeben {0}</translation>
    </message>
    <message>
        <source>saving photos</source>
        <translation>Fotos werden gesichert</translation>
    </message>
    <message>
        <source>says that it has more numbers than it holds; get the file again</source>
        <translation>gibt mehr Zahlen an, als es enthält; neu holen</translation>
    </message>
    <message>
        <source>says that it has {0} points, {1} bytes, and {2} bytes follow its header; the file is cut off or damaged</source>
        <translation>gibt {0} Punkte mit {1} Bytes an, und {2} Bytes folgen seinem Kopf; die Datei ist abgeschnitten oder beschädigt</translation>
    </message>
    <message>
        <source>says that it has {0} points; at most {1} are read</source>
        <translation>gibt {0} Punkte an; höchstens {1} werden gelesen</translation>
    </message>
    <message>
        <source>says two units of height: {0} m with its heights and {1} m in its reference system; say the right one with --height-unit</source>
        <translation>nennt zwei Einheiten der Höhe: {0} m bei den Höhen und {1} m im Referenzsystem; die richtige mit --height-unit angeben</translation>
    </message>
    <message>
        <source>scheduler and workers need the same program and libraries as here; {0} {1}: install it there</source>
        <translation>Scheduler und Worker brauchen dasselbe Programm und dieselben Bibliotheken wie hier; {0} {1}: dort installieren</translation>
    </message>
    <message>
        <source>scoring views</source>
        <translation>Ansichten werden bewertet</translation>
    </message>
    <message>
        <source>scoring {0}</source>
        <translation>{0} wird bewertet</translation>
    </message>
    <message>
        <source>sections covered</source>
        <translation>abgedeckte Sektoren</translation>
    </message>
    <message>
        <source>sections no other plan covers</source>
        <translation>Sektoren nur in diesem Plan</translation>
    </message>
    <message>
        <source>seen at least twice: {0} sections</source>
        <translation>mindestens zweimal gesehen: {0} Sektoren</translation>
    </message>
    <message>
        <source>seen: {0} of {1} directions of view ({2} for each of {3})</source>
        <translation>gesehen: {0} von {1} Blickrichtungen ({2} für jede von {3})</translation>
    </message>
    <message>
        <source>send the mission to the vehicle</source>
        <translation>die Mission zum Fluggerät schicken</translation>
    </message>
    <message>
        <source>serial number &apos;{0}&apos;: expected at most {1} letters and digits</source>
        <translation>Seriennummer &apos;{0}&apos;: erwartet wurden höchstens {1} Buchstaben und Ziffern</translation>
    </message>
    <message>
        <source>setting</source>
        <translation>Einstellung</translation>
    </message>
    <message>
        <source>share of the error</source>
        <translation>Anteil am Fehler</translation>
    </message>
    <message>
        <source>share of the pixels</source>
        <translation>Anteil der Pixel</translation>
    </message>
    <message>
        <source>shows other panels than the model; name photos of the same site</source>
        <translation>zeigt andere Scheiben als das Modell; Fotos desselben Standorts nennen</translation>
    </message>
    <message>
        <source>shows other panels than were learned from; name photos of the same site</source>
        <translation>zeigt andere Scheiben als die gelernten; Fotos desselben Standorts nennen</translation>
    </message>
    <message>
        <source>simulated fly-aways: {0} of {1} ended inside; smallest distance to the border {2} m</source>
        <translation>simulierte Ausreißer: {0} von {1} endeten innerhalb; kleinster Abstand zum Rand {2} m</translation>
    </message>
    <message>
        <source>simulated {0}</source>
        <translation>simuliertes {0}</translation>
    </message>
    <message>
        <source>simulation, {0} times as fast</source>
        <translation>Simulation, {0}-mal so schnell</translation>
    </message>
    <message>
        <source>site &apos;{0}&apos; without terrain</source>
        <translation>Standort &apos;{0}&apos; ohne Gelände</translation>
    </message>
    <message>
        <source>site &apos;{0}&apos;, {1}</source>
        <translation>Standort &apos;{0}&apos;, {1}</translation>
    </message>
    <message>
        <source>site:     {0}</source>
        <translation>Standort: {0}</translation>
    </message>
    <message>
        <source>site:    none yet</source>
        <translation>Standort: noch keiner</translation>
    </message>
    <message>
        <source>site:    {0}, {1} ({2})</source>
        <translation>Standort: {0}, {1} ({2})</translation>
    </message>
    <message>
        <source>size</source>
        <translation>Größe</translation>
    </message>
    <message>
        <source>sized for calm air: any wind carries a falling aircraft beyond the buffer</source>
        <translation>für Windstille bemessen: jeder Wind trägt ein fallendes Fluggerät über den Puffer hinaus</translation>
    </message>
    <message>
        <source>sized for {0} m/s; where a mode limits it to the plan&apos;s {1} m/s, state that as full speed</source>
        <translation>für {0} m/s bemessen; wo ein Modus auf die {1} m/s des Plans begrenzt, geben Sie diese als volle Geschwindigkeit an</translation>
    </message>
    <message>
        <source>smallest clearance</source>
        <translation>kleinster Abstand</translation>
    </message>
    <message>
        <source>smallest distance between aircraft that start as planned, {0} s after the first start</source>
        <translation>kleinster Abstand zwischen Fluggeräten, die wie geplant starten, {0} s nach dem ersten Start</translation>
    </message>
    <message>
        <source>somebody else reads its files</source>
        <translation>jemand anderes liest seine Dateien</translation>
    </message>
    <message>
        <source>something stands in front of panels in {0} of {1} photos looked at</source>
        <translation>auf {0} von {1} betrachteten Fotos steht etwas vor Scheiben</translation>
    </message>
    <message>
        <source>sorties {0} and {1}</source>
        <translation>Einsätze {0} und {1}</translation>
    </message>
    <message>
        <source>sorties {0} and {1} need one aircraft at the same time; plan the flight again</source>
        <translation>Einsätze {0} und {1} brauchen zugleich dasselbe Fluggerät; den Flug neu planen</translation>
    </message>
    <message>
        <source>sorties {0} at once</source>
        <translation>Einsätze {0} zugleich</translation>
    </message>
    <message>
        <source>sound</source>
        <translation>unbeschädigt</translation>
    </message>
    <message>
        <source>source</source>
        <translation>Quelle</translation>
    </message>
    <message>
        <source>speed</source>
        <translation>Tempo</translation>
    </message>
    <message>
        <source>splats</source>
        <translation>Splats</translation>
    </message>
    <message>
        <source>splats begin on points, not on the mesh</source>
        <translation>Splats beginnen auf Punkten, nicht auf dem Netz</translation>
    </message>
    <message>
        <source>spread</source>
        <translation>Streuung</translation>
    </message>
    <message>
        <source>spread of the gains&apos; logarithms</source>
        <translation>Streuung der Logarithmen der Verstärkungen</translation>
    </message>
    <message>
        <source>start; it asks first</source>
        <translation>starten; es wird vorher gefragt</translation>
    </message>
    <message>
        <source>starting the simulation</source>
        <translation>die Simulation beginnt</translation>
    </message>
    <message>
        <source>state</source>
        <translation>Zustand</translation>
    </message>
    <message>
        <source>state how many people are below; without that there is no ground risk class</source>
        <translation>geben Sie an, wie viele Menschen darunter sind; ohne das gibt es keine Bodenrisikoklasse</translation>
    </message>
    <message>
        <source>stated by the pilot</source>
        <translation>Angabe des Piloten</translation>
    </message>
    <message>
        <source>steps</source>
        <translation>Schritte</translation>
    </message>
    <message>
        <source>steps of {0} m from heights {1} m apart: bounds at most {2} m off, and {3} m for the accuracy</source>
        <translation>Schritte von {0} m aus Höhen im Abstand von {1} m: Schranken höchstens {2} m daneben, dazu {3} m für die Genauigkeit</translation>
    </message>
    <message>
        <source>stop once the curve is flat, or let it end by itself</source>
        <translation>stoppen, wenn die Kurve flach ist, oder das Ende abwarten</translation>
    </message>
    <message>
        <source>strongest that the aircraft may fly in</source>
        <translation>stärkster, in dem das Fluggerät fliegen darf</translation>
    </message>
    <message>
        <source>sum of this program, see the guide</source>
        <translation>Rechnung dieses Programms, siehe Anleitung</translation>
    </message>
    <message>
        <source>sun</source>
        <translation>Sonne</translation>
    </message>
    <message>
        <source>sun at heading {0}, elevation {1} degrees</source>
        <translation>Sonne in Richtung {0}, Höhe {1} Grad</translation>
    </message>
    <message>
        <source>sun in panes</source>
        <translation>Sonne in Scheiben</translation>
    </message>
    <message>
        <source>sun in pictures</source>
        <translation>Sonne in Bildern</translation>
    </message>
    <message>
        <source>sun over &apos;{0}&apos; on {1} ({2})</source>
        <translation>Sonne über &apos;{0}&apos; am {1} ({2})</translation>
    </message>
    <message>
        <source>sun over the pilot</source>
        <translation>Sonne über dem Piloten</translation>
    </message>
    <message>
        <source>symbol</source>
        <translation>Zeichen</translation>
    </message>
    <message>
        <source>tactical mitigations and safety objectives (OSO)</source>
        <translation>taktische Minderungen und Sicherheitsziele (OSO)</translation>
    </message>
    <message>
        <source>take off at {0} (as good: {1})</source>
        <translation>Start um {0} (ebenso gut: {1})</translation>
    </message>
    <message>
        <source>take-off</source>
        <translation>Start</translation>
    </message>
    <message>
        <source>take-off mass</source>
        <translation>Startmasse</translation>
    </message>
    <message>
        <source>takeOffRefPoint {0},{1} is not on the globe and is not used</source>
        <translation>takeOffRefPoint {0},{1} liegt nicht auf der Erde und wird nicht benutzt</translation>
    </message>
    <message>
        <source>taken back: {0}</source>
        <translation>zurückgenommen: {0}</translation>
    </message>
    <message>
        <source>taken out</source>
        <translation>herausgenommen</translation>
    </message>
    <message>
        <source>template and waylines name different aircraft: {0}, {1}</source>
        <translation>template und waylines nennen verschiedene Fluggeräte: {0}, {1}</translation>
    </message>
    <message>
        <source>template and waylines name different cameras</source>
        <translation>template und waylines nennen verschiedene Kameras</translation>
    </message>
    <message>
        <source>terrain and site differ by {0} m at home: where the ground is level there, one of them is wrong; &apos;--shift home&apos; brings the terrain to the site</source>
        <translation>Gelände und Standort unterscheiden sich am Startplatz um {0} m: ist der Boden dort eben, stimmt eines von beiden nicht; &apos;--shift home&apos; bringt das Gelände zum Standort</translation>
    </message>
    <message>
        <source>terrain from {0} m to {1} m in the site&apos;s own frame, known on {2} % of the area</source>
        <translation>Gelände von {0} m bis {1} m im eigenen System des Standorts, bekannt auf {2} % der Fläche</translation>
    </message>
    <message>
        <source>the AIXM file {0}; expected airspaces alone</source>
        <translation>die AIXM-Datei {0}; erwartet werden nur Lufträume</translation>
    </message>
    <message>
        <source>the KML file {0}; expected areas alone</source>
        <translation>die KML-Datei {0}; erwartet werden nur Flächen</translation>
    </message>
    <message>
        <source>the ULog cannot be read ({0}); copy it from the vehicle again</source>
        <translation>das ULog ist nicht lesbar ({0}); noch einmal vom Fluggerät kopieren</translation>
    </message>
    <message>
        <source>the ULog is damaged beyond reading; copy it from the vehicle again</source>
        <translation>das ULog ist unlesbar beschädigt; noch einmal vom Fluggerät kopieren</translation>
    </message>
    <message>
        <source>the address holds a password, a space or a letter that addresses do not have</source>
        <translation>die Adresse enthält ein Passwort, ein Leerzeichen oder einen Buchstaben, den Adressen nicht haben</translation>
    </message>
    <message>
        <source>the aircraft did not fly while this log was written; take the log of the flight</source>
        <translation>das Fluggerät flog nicht, während dieses Log geschrieben wurde; das Log des Fluges nehmen</translation>
    </message>
    <message>
        <source>the aircraft flies at {0} m/s, which is all that DJI&apos;s format takes, and not at the plan&apos;s {1} m/s: the flight takes longer than planned; plan with the lower speed</source>
        <translation>das Fluggerät fliegt mit {0} m/s, mehr lässt DJIs Format nicht zu, und nicht mit den {1} m/s des Plans: der Flug dauert länger als geplant; mit der kleineren Geschwindigkeit planen</translation>
    </message>
    <message>
        <source>the aircraft is larger or faster than SORA&apos;s table goes; ask the authority</source>
        <translation>das Fluggerät ist größer oder schneller, als die Tabelle von SORA reicht; fragen Sie die Behörde</translation>
    </message>
    <message>
        <source>the aircraft&apos;s serial number is missing: enter it in the settings, or set it in the module</source>
        <translation>die Seriennummer des Luftfahrzeugs fehlt: tragen Sie sie in den Einstellungen ein oder setzen Sie sie im Modul</translation>
    </message>
    <message>
        <source>the airspace is {0} m by {1} m, as far as the photos were taken: what stands behind their cameras is not known; widen it where you have looked</source>
        <translation>der Luftraum misst {0} m mal {1} m, so weit, wie Fotos gemacht wurden: was hinter ihren Kameras steht, ist nicht bekannt; dort erweitern, wo nachgesehen wurde</translation>
    </message>
    <message>
        <source>the annotation has {0} x {1} pixels, its photo {2} x {3}</source>
        <translation>die Annotation hat {0} x {1} Pixel, ihr Foto {2} x {3}</translation>
    </message>
    <message>
        <source>the battery on board</source>
        <translation>dem eingesetzten Akku</translation>
    </message>
    <message>
        <source>the battery on board flies one sortie; ask for it, or for full ones</source>
        <translation>der Akku an Bord fliegt einen Einsatz; entweder ihn verlangen oder volle</translation>
    </message>
    <message>
        <source>the building without panels</source>
        <translation>das Gebäude ohne Scheiben</translation>
    </message>
    <message>
        <source>the camera model {0} is not supported; expected one of {1}; undistort the images with COLMAP (image_undistorter), which then writes PINHOLE cameras</source>
        <translation>das Kameramodell {0} wird nicht unterstützt; erwartet wird eines von {1}; die Bilder mit COLMAP entzerren (image_undistorter), das dann PINHOLE-Kameras schreibt</translation>
    </message>
    <message>
        <source>the camera says that photo {0} failed</source>
        <translation>die Kamera meldet, dass Foto {0} nicht gelang</translation>
    </message>
    <message>
        <source>the cluster does not answer any more ({0}); complete photos stay in {1}: run it again to go on</source>
        <translation>der Cluster antwortet nicht mehr ({0}); fertige Fotos bleiben in {1}: noch einmal starten, um weiterzumachen</translation>
    </message>
    <message>
        <source>the contingency volume reaches into the no-fly zone &apos;{0}&apos;</source>
        <translation>das Notfallvolumen reicht in die Flugverbotszone &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>the control points say the size of the model to {0} % only</source>
        <translation>die Passpunkte sagen die Größe des Modells nur auf {0} %</translation>
    </message>
    <message>
        <source>the control points were marked in photos of another size: their pixels fit when multiplied by {0}</source>
        <translation>die Passpunkte wurden in Fotos einer anderen Größe markiert: ihre Pixel passen, wenn man sie mit {0} malnimmt</translation>
    </message>
    <message>
        <source>the convex facade alone, with everything else far away</source>
        <translation>die konvexe Fassade allein, alles andere weit weg</translation>
    </message>
    <message>
        <source>the data of the file do not end (ENDSEC is missing)</source>
        <translation>die Daten der Datei enden nicht (ENDSEC fehlt)</translation>
    </message>
    <message>
        <source>the data set is made</source>
        <translation>der Datensatz ist erstellt</translation>
    </message>
    <message>
        <source>the data set is there</source>
        <translation>der Datensatz ist da</translation>
    </message>
    <message>
        <source>the decoder of the video has ended</source>
        <translation>der Dekoder des Videos ist beendet</translation>
    </message>
    <message>
        <source>the device was removed, or no longer answers ({0}); connect it and send again</source>
        <translation>das Gerät wurde entfernt oder antwortet nicht mehr ({0}); schließen Sie es an und senden Sie erneut</translation>
    </message>
    <message>
        <source>the ellipsoid</source>
        <translation>das Ellipsoid</translation>
    </message>
    <message>
        <source>the facade&apos;s horizon runs through its middle: it is seen edge-on, or the lines are wrong</source>
        <translation>der Horizont der Fassade geht durch ihre Mitte: sie ist von der Kante zu sehen, oder die Linien sind falsch</translation>
    </message>
    <message>
        <source>the file does not say when this applies</source>
        <translation>die Datei sagt nicht, wann das gilt</translation>
    </message>
    <message>
        <source>the file does not say where this zone lies</source>
        <translation>die Datei sagt nicht, wo diese Zone liegt</translation>
    </message>
    <message>
        <source>the file gives no lower limit</source>
        <translation>die Datei nennt keine Untergrenze</translation>
    </message>
    <message>
        <source>the file gives no upper limit</source>
        <translation>die Datei nennt keine Obergrenze</translation>
    </message>
    <message>
        <source>the file is protected</source>
        <translation>die Datei ist geschützt</translation>
    </message>
    <message>
        <source>the file says &apos;{0}&apos; of &apos;{1}&apos;, which is not known here</source>
        <translation>die Datei sagt &apos;{0}&apos; zu &apos;{1}&apos;, was hier nicht bekannt ist</translation>
    </message>
    <message>
        <source>the file says where this is, but not what it means; until you say, it counts as prohibited</source>
        <translation>die Datei sagt, wo das ist, aber nicht, was es bedeutet; bis Sie es sagen, gilt es als verboten</translation>
    </message>
    <message>
        <source>the flight geography reaches {0} m above ground; above {1} m other rules hold</source>
        <translation>die Fluggeographie reicht {0} m über Grund; über {1} m gelten andere Regeln</translation>
    </message>
    <message>
        <source>the flight is {0} km from the site &apos;{1}&apos;; expected at most {2} km; is it the right log, and the right site?</source>
        <translation>der Flug ist {0} km vom Standort &apos;{1}&apos; entfernt; erwartet werden höchstens {2} km; ist es das richtige Log und der richtige Standort?</translation>
    </message>
    <message>
        <source>the folder has no files of heights; expected .tif or .hgt</source>
        <translation>der Ordner hat keine Dateien mit Höhen; erwartet .tif oder .hgt</translation>
    </message>
    <message>
        <source>the folder has {0} files that may cover the site; expected at most {1}; name the right ones</source>
        <translation>der Ordner hat {0} Dateien, die den Standort abdecken können; erwartet höchstens {1}; die richtigen angeben</translation>
    </message>
    <message>
        <source>the following arguments are required: %s</source>
        <translation>folgende Argumente fehlen: %s</translation>
    </message>
    <message>
        <source>the ground</source>
        <translation>der Boden</translation>
    </message>
    <message>
        <source>the ground falls away as far as the buffer is widened; limit speed or wind</source>
        <translation>der Boden fällt ab, so weit der Puffer auch wird; begrenzen Sie Geschwindigkeit oder Wind</translation>
    </message>
    <message>
        <source>the ground falls by {0} degrees; heights count from the building&apos;s foot</source>
        <translation>der Boden fällt um {0} Grad; Höhen zählen vom Fuß des Gebäudes</translation>
    </message>
    <message>
        <source>the ground risk cannot be assessed: {0}</source>
        <translation>das Bodenrisiko kann nicht bewertet werden: {0}</translation>
    </message>
    <message>
        <source>the ground station disconnected; the aircraft went on by itself</source>
        <translation>die Bodenstation hat die Verbindung getrennt; das Fluggerät flog allein weiter</translation>
    </message>
    <message>
        <source>the ground-risk buffer reaches into the no-fly zone &apos;{0}&apos;</source>
        <translation>der Bodenrisikopuffer reicht in die Flugverbotszone &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>the height &apos;{0}&apos; cannot be read</source>
        <translation>die Höhe &apos;{0}&apos; ist nicht lesbar</translation>
    </message>
    <message>
        <source>the height &apos;{0}&apos; does not say whether it is above ground or sea</source>
        <translation>die Höhe &apos;{0}&apos; sagt nicht, ob sie über Grund oder über dem Meer zählt</translation>
    </message>
    <message>
        <source>the heights are damaged (expected {0} nodes, found {1}); attach the terrain again</source>
        <translation>die Höhen sind beschädigt (erwartet {0} Knoten, gefunden {1}); das Gelände neu anhängen</translation>
    </message>
    <message>
        <source>the heights are damaged ({0}); attach the terrain again</source>
        <translation>die Höhen sind beschädigt ({0}); das Gelände neu anhängen</translation>
    </message>
    <message>
        <source>the image name at byte {0} has no end; the file is damaged</source>
        <translation>der Bildname bei Byte {0} hat kein Ende; die Datei ist beschädigt</translation>
    </message>
    <message>
        <source>the last is {0} s old, from {1}</source>
        <translation>die letzte ist {0} s alt, von {1}</translation>
    </message>
    <message>
        <source>the latitude is {0} degrees; expected -90 to 90{1}</source>
        <translation>die Breite ist {0} Grad; erwartet wird -90 bis 90{1}</translation>
    </message>
    <message>
        <source>the lens moves pixels by up to {0} px</source>
        <translation>das Objektiv verschiebt Pixel um bis zu {0} px</translation>
    </message>
    <message>
        <source>the licence is missing; enter the words that the map&apos;s owner asks for, such as © OpenStreetMap contributors</source>
        <translation>die Lizenz fehlt; die Worte eingeben, die der Besitzer der Karte verlangt, etwa © OpenStreetMap-Mitwirkende</translation>
    </message>
    <message>
        <source>the link to the simulated vehicle is closed</source>
        <translation>der Link zum simulierten Fluggerät ist geschlossen</translation>
    </message>
    <message>
        <source>the log has no fused positions (POS); those of the GNSS receiver are taken</source>
        <translation>das Log hat keine fusionierten Positionen (POS); die des GNSS-Empfängers werden genommen</translation>
    </message>
    <message>
        <source>the log has no fused positions; those of the GNSS receiver are taken</source>
        <translation>das Log hat keine fusionierten Positionen; die des GNSS-Empfängers werden genommen</translation>
    </message>
    <message>
        <source>the log has no heights above take-off; those above sea level are taken</source>
        <translation>das Log hat keine Höhen über Start; die über Meer werden genommen</translation>
    </message>
    <message>
        <source>the log has {0} gaps, {1} s together</source>
        <translation>das Log hat {0} Lücken, zusammen {1} s</translation>
    </message>
    <message>
        <source>the log is empty; copy it from the vehicle again</source>
        <translation>das Log ist leer; noch einmal vom Fluggerät kopieren</translation>
    </message>
    <message>
        <source>the log says nothing for {0} s</source>
        <translation>das Log sagt {0} s lang nichts</translation>
    </message>
    <message>
        <source>the log tells when photos were triggered, not that they were taken</source>
        <translation>das Log sagt, wann Fotos ausgelöst wurden, nicht dass sie aufgenommen wurden</translation>
    </message>
    <message>
        <source>the log was not fetched: stopped</source>
        <translation>das Log wurde nicht geholt: abgebrochen</translation>
    </message>
    <message>
        <source>the log was not fetched: the vehicle is armed</source>
        <translation>das Log wurde nicht geholt: das Fahrzeug ist scharf</translation>
    </message>
    <message>
        <source>the logs on the vehicle are empty</source>
        <translation>die Logs auf dem Fahrzeug sind leer</translation>
    </message>
    <message>
        <source>the longitude is {0} degrees; expected -180 to 180</source>
        <translation>die Länge ist {0} Grad; erwartet wird -180 bis 180</translation>
    </message>
    <message>
        <source>the lower bound</source>
        <translation>die untere Schranke</translation>
    </message>
    <message>
        <source>the map is compressed with {0}; expected gzip, Zstandard or none; convert it with the program pmtiles</source>
        <translation>die Karte ist mit {0} komprimiert; erwartet wird gzip, Zstandard oder nichts; mit dem Programm pmtiles umwandeln</translation>
    </message>
    <message>
        <source>the map server {0} cannot be reached ({1})</source>
        <translation>der Kartenserver {0} ist nicht erreichbar ({1})</translation>
    </message>
    <message>
        <source>the map server {0} does not answer</source>
        <translation>der Kartenserver {0} antwortet nicht</translation>
    </message>
    <message>
        <source>the map server {0} does not let Reflight in (answer {1}); look at its terms of use</source>
        <translation>der Kartenserver {0} lässt Reflight nicht zu (Antwort {1}); seine Nutzungsbedingungen ansehen</translation>
    </message>
    <message>
        <source>the map server {0} is busy or broken (answer {1})</source>
        <translation>der Kartenserver {0} ist überlastet oder gestört (Antwort {1})</translation>
    </message>
    <message>
        <source>the map server {0} sends elsewhere; enter the address that it sends to</source>
        <translation>der Kartenserver {0} verweist woandershin; die Adresse eingeben, auf die er verweist</translation>
    </message>
    <message>
        <source>the map server {0} sent more than {1} MiB for a tile</source>
        <translation>der Kartenserver {0} hat mehr als {1} MiB für eine Kachel geschickt</translation>
    </message>
    <message>
        <source>the map server {0} sent something else than a map tile ({1}); look at the address</source>
        <translation>der Kartenserver {0} hat etwas anderes als eine Kartenkachel geschickt ({1}); die Adresse prüfen</translation>
    </message>
    <message>
        <source>the mission is called &apos;{0}&apos; there: DJI&apos;s apps take no dots and underscores in names</source>
        <translation>die Mission heißt dort &apos;{0}&apos;: DJIs Apps nehmen keine Punkte und Unterstriche in Namen</translation>
    </message>
    <message>
        <source>the mission is on board</source>
        <translation>die Mission ist an Bord</translation>
    </message>
    <message>
        <source>the model is open</source>
        <translation>das Modell ist offen</translation>
    </message>
    <message>
        <source>the model misses the control points by {0} m in the median; a receiver without corrections measures them no better, else look at their coordinates, the order of east and north, and their pixels</source>
        <translation>das Modell verfehlt die Passpunkte im Median um {0} m; ein Empfänger ohne Korrekturen misst sie nicht besser, sonst sehen Sie Koordinaten, Reihenfolge von Ost und Nord und Pixel nach</translation>
    </message>
    <message>
        <source>the model that a flight brings, on unseen views of &apos;{0}&apos;</source>
        <translation>das Modell, das ein Flug bringt, in ungesehenen Ansichten von &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>the module has been silent for {0} s; it may not let the aircraft arm</source>
        <translation>das Modul schweigt seit {0} s; vielleicht lässt es das Luftfahrzeug nicht scharf werden</translation>
    </message>
    <message>
        <source>the module is content</source>
        <translation>das Modul ist zufrieden</translation>
    </message>
    <message>
        <source>the name does not say where the tile lies; expected one such as N22E114.hgt</source>
        <translation>der Name sagt nicht, wo die Kachel liegt; erwartet etwas wie N22E114.hgt</translation>
    </message>
    <message>
        <source>the name says a place that is not on earth</source>
        <translation>der Name nennt einen Ort, den es auf der Erde nicht gibt</translation>
    </message>
    <message>
        <source>the nearest neighbour ends where there is no leg back; take another method</source>
        <translation>der nächste Nachbar endet, wo keine Strecke zurückführt; ein anderes Verfahren nehmen</translation>
    </message>
    <message>
        <source>the network sees no glass on {0} % of {1} panels, and {2} % of its glass lies outside them</source>
        <translation>das Netz sieht auf {0} % von {1} Scheiben kein Glas, und {2} % seines Glases liegen außerhalb davon</translation>
    </message>
    <message>
        <source>the northing {0} m does not lie in band {1}</source>
        <translation>der Nordwert {0} m liegt nicht im Band {1}</translation>
    </message>
    <message>
        <source>the online map is off</source>
        <translation>die Onlinekarte ist aus</translation>
    </message>
    <message>
        <source>the operator number has the right form; with its secret part its checksum can be proved</source>
        <translation>die Betreibernummer hat die richtige Form; mit ihrem geheimen Teil lässt sich ihre Prüfsumme beweisen</translation>
    </message>
    <message>
        <source>the optimum</source>
        <translation>das Optimum</translation>
    </message>
    <message>
        <source>the origin of &apos;{0}&apos; is not the one of the plan, which is for &apos;{1}&apos;; name the site file that the plan was made for</source>
        <translation>der Ursprung von &apos;{0}&apos; ist nicht der des Plans, der für &apos;{1}&apos; ist; die Standortdatei nennen, für die der Plan gemacht wurde</translation>
    </message>
    <message>
        <source>the output cannot be written ({0})</source>
        <translation>die Ausgabe ist nicht zu schreiben ({0})</translation>
    </message>
    <message>
        <source>the panes mirror nothing but sky</source>
        <translation>die Scheiben spiegeln nur Himmel</translation>
    </message>
    <message>
        <source>the photos are straight</source>
        <translation>die Fotos sind unverzeichnet</translation>
    </message>
    <message>
        <source>the photos do not say where they were taken, so the COLMAP model counts as one in the frame of the site</source>
        <translation>die Fotos sagen nicht, wo sie aufgenommen wurden, deshalb gilt das COLMAP-Modell als eines im System des Standorts</translation>
    </message>
    <message>
        <source>the photos look straight down, where walls do not show: fly around the building too, with the camera 20 to 45 degrees below the horizon</source>
        <translation>die Fotos blicken senkrecht hinab, wo man keine Wände sieht: umfliegen Sie das Gebäude auch, mit der Kamera 20 bis 45 Grad unter dem Horizont</translation>
    </message>
    <message>
        <source>the photos of this coarse model were in {0}, which is not there</source>
        <translation>die Fotos dieses Grobmodells lagen in {0}, das es nicht mehr gibt</translation>
    </message>
    <message>
        <source>the photos show {0} of the {1} sections that the plan promised ({2} %)</source>
        <translation>die Fotos zeigen {0} der {1} Sektoren, die der Plan versprach ({2} %)</translation>
    </message>
    <message>
        <source>the photos were taken at places up to {0} km apart; put those of one building into a folder of their own</source>
        <translation>die Fotos wurden an Orten aufgenommen, die bis zu {0} km auseinander liegen; legen Sie die eines Gebäudes in einen eigenen Ordner</translation>
    </message>
    <message>
        <source>the photos were taken from the ground: what stands behind their cameras is not known, look around</source>
        <translation>die Fotos wurden vom Boden aus gemacht: was hinter ihren Kameras steht, ist nicht bekannt; vor dem Flug umsehen</translation>
    </message>
    <message>
        <source>the picture cannot be written</source>
        <translation>das Bild ist nicht zu schreiben</translation>
    </message>
    <message>
        <source>the picture does not say where it lies; export it as GeoTIFF with a reference system</source>
        <translation>das Bild sagt nicht, wo es liegt; als GeoTIFF mit Bezugssystem exportieren</translation>
    </message>
    <message>
        <source>the picture is distorted, and splats are rendered without distortion; make it straight with `prepare`</source>
        <translation>das Bild ist verzeichnet, und Splats werden ohne Verzeichnung gerendert; mit `prepare` entzerren</translation>
    </message>
    <message>
        <source>the plan has no sorties, so there is nothing that could fall; plan a flight first</source>
        <translation>der Plan hat keine Flüge, also kann nichts abstürzen; planen Sie zuerst einen Flug</translation>
    </message>
    <message>
        <source>the plan is NOT ready to fly: the brief lists why</source>
        <translation>der Plan ist NICHT flugbereit: das Flugblatt sagt, warum</translation>
    </message>
    <message>
        <source>the plan is for the site &apos;{0}&apos;; name its site file as well</source>
        <translation>der Plan ist für den Standort &apos;{0}&apos;; auch dessen Standortdatei nennen</translation>
    </message>
    <message>
        <source>the plan promised {0} sections; {1} of them are missing</source>
        <translation>der Plan versprach {0} Sektoren; {1} davon fehlen</translation>
    </message>
    <message>
        <source>the plane facade alone, with everything else far away</source>
        <translation>die ebene Fassade allein, alles andere weit weg</translation>
    </message>
    <message>
        <source>the points do not determine a polynomial of degree {0}: they are in line</source>
        <translation>die Punkte bestimmen kein Polynom vom Grad {0}: sie liegen auf einer Linie</translation>
    </message>
    <message>
        <source>the positions of {0} of {1} photos are more than {2} km from the others: they are not used</source>
        <translation>die Positionen von {0} von {1} Fotos liegen mehr als {2} km von den anderen: sie werden nicht verwendet</translation>
    </message>
    <message>
        <source>the positions of {0} of {1} photos contradict the model</source>
        <translation>die Positionen von {0} von {1} Fotos widersprechen dem Modell</translation>
    </message>
    <message>
        <source>the reader of IFC files crashed on this one (status {0}), so something in it goes in circles or beyond all bounds; open and export it again in a BIM program</source>
        <translation>der Leser von IFC-Dateien stürzte bei dieser ab (Status {0}), etwas darin geht also im Kreis oder über alle Grenzen; sie in einem BIM-Programm öffnen und neu exportieren</translation>
    </message>
    <message>
        <source>the remote ID module is silent: look at its power, its wiring and DID_MAVPORT</source>
        <translation>das Remote-ID-Modul schweigt: prüfen Sie Strom, Verkabelung und DID_MAVPORT</translation>
    </message>
    <message>
        <source>the return height is none that DJI&apos;s remote controllers take: expected {0} to {1} m above take-off, got {2} m</source>
        <translation>diese Rückkehrhöhe nehmen DJIs Fernsteuerungen nicht an: erwartet {0} bis {1} m über dem Startplatz, angegeben sind {2} m</translation>
    </message>
    <message>
        <source>the return height would have to be {0} m above take-off: DJI&apos;s remote controllers take no more than {1} m</source>
        <translation>die Rückkehrhöhe müsste {0} m über dem Startplatz sein: DJIs Fernsteuerungen nehmen höchstens {1} m an</translation>
    </message>
    <message>
        <source>the same on a convex facade</source>
        <translation>dasselbe an einer konvexen Fassade</translation>
    </message>
    <message>
        <source>the same points are brighter or darker by {0} % in other photos</source>
        <translation>dieselben Punkte sind in anderen Fotos um {0} % heller oder dunkler</translation>
    </message>
    <message>
        <source>the sample project cannot be written: {0}</source>
        <translation>das Beispielprojekt kann nicht geschrieben werden: {0}</translation>
    </message>
    <message>
        <source>the shortest there is</source>
        <translation>die kürzeste überhaupt</translation>
    </message>
    <message>
        <source>the site file has changed since the plan was made; photos show it as it is now</source>
        <translation>die Standortdatei hat sich geändert, seit der Plan gemacht wurde; Fotos zeigen sie, wie sie jetzt ist</translation>
    </message>
    <message>
        <source>the site has another origin than when the plan was made; plan again on the site as it is</source>
        <translation>der Standort hat einen anderen Ursprung als bei der Planung; planen Sie neu auf dem Standort, wie er ist</translation>
    </message>
    <message>
        <source>the site has no building mesh, and panels are found on one; name a mesh instead</source>
        <translation>der Standort hat kein Gebäudenetz, und Scheiben werden auf einem gefunden; stattdessen ein Netz nennen</translation>
    </message>
    <message>
        <source>the site has no file of geo-zones &apos;{0}&apos;; it has: {1}</source>
        <translation>der Standort hat keine Datei mit Geozonen &apos;{0}&apos;; er hat: {1}</translation>
    </message>
    <message>
        <source>the site has no geo-zones, so which apply here is not looked at</source>
        <translation>der Standort hat keine Geozonen, darum wird nicht geprüft, welche hier gelten</translation>
    </message>
    <message>
        <source>the site has no panel &apos;{0}&apos;</source>
        <translation>der Standort hat kein Panel &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>the site has no panels</source>
        <translation>der Standort hat keine Paneele</translation>
    </message>
    <message>
        <source>the site has no panels yet</source>
        <translation>der Standort hat noch keine Scheiben</translation>
    </message>
    <message>
        <source>the site has no terrain</source>
        <translation>der Standort hat kein Gelände</translation>
    </message>
    <message>
        <source>the site needs panels first</source>
        <translation>der Standort braucht zuerst Scheiben</translation>
    </message>
    <message>
        <source>the site that this plan was made for is not beside it; name its file, too</source>
        <translation>der Ort, für den dieser Plan gemacht ist, liegt nicht daneben; nennen Sie auch seine Datei</translation>
    </message>
    <message>
        <source>the site would be written over the file it is imported from; name another file</source>
        <translation>der Standort würde über die Datei geschrieben, aus der er importiert wird; eine andere Datei nennen</translation>
    </message>
    <message>
        <source>the size is a guess, wrong by up to a factor of {0}: cameras are taken to be {1} m above the lowest ground that was found. Before anything is flown, measure how far apart two photos were taken, or survey control points, and state it</source>
        <translation>die Größe ist geraten und kann um den Faktor {0} falsch sein: Kameras gelten als {1} m über dem tiefsten gefundenen Boden. Messen Sie, bevor geflogen wird, wie weit zwei Fotos auseinander aufgenommen wurden, oder Passpunkte, und geben Sie es an</translation>
    </message>
    <message>
        <source>the size of the model is known to {0} % only: the receivers are off by too much for photos that are {1} m apart; state a distance or control points</source>
        <translation>die Größe des Modells ist nur auf {0} % bekannt: die Empfänger liegen zu weit daneben für Fotos, die {1} m auseinander sind; geben Sie eine Strecke oder Passpunkte an</translation>
    </message>
    <message>
        <source>the sorties of several aircraft have no starts any more; plan the flight again</source>
        <translation>die Einsätze mehrerer Fluggeräte haben keine Startzeiten mehr; den Flug neu planen</translation>
    </message>
    <message>
        <source>the sun does not rise on this day</source>
        <translation>die Sonne geht an diesem Tag nicht auf</translation>
    </message>
    <message>
        <source>the sun is before its panes on this day</source>
        <translation>die Sonne steht an diesem Tag vor ihren Scheiben</translation>
    </message>
    <message>
        <source>the sun is in the picture of {0} of {1} photos with take-off at {2}</source>
        <translation>mit Start um {2} ist die Sonne in {0} von {1} Fotos im Bild</translation>
    </message>
    <message>
        <source>the sun is never before its panes on this day</source>
        <translation>die Sonne steht an diesem Tag nie vor ihren Scheiben</translation>
    </message>
    <message>
        <source>the sun sets before the last sortie has landed</source>
        <translation>die Sonne geht unter, bevor der letzte Einsatz gelandet ist</translation>
    </message>
    <message>
        <source>the sun stands within {0} degrees of the aircraft as the pilot sees it from home for {1} s with take-off at {2}: fly at another time, or with an observer who stands elsewhere</source>
        <translation>mit Start um {2} steht die Sonne, vom Startplatz des Piloten aus gesehen, {1} s lang weniger als {0} Grad neben dem Fluggerät: zu anderer Zeit fliegen, oder mit einem Beobachter, der anderswo steht</translation>
    </message>
    <message>
        <source>the surface</source>
        <translation>die Oberfläche</translation>
    </message>
    <message>
        <source>the surface makes more than {0} separate obstacles; give a longer --resolution, or a greater --taller-than</source>
        <translation>die Oberfläche ergibt mehr als {0} einzelne Hindernisse; eine gröbere --resolution oder ein größeres --taller-than angeben</translation>
    </message>
    <message>
        <source>the table is empty; expected a line with the names of its columns</source>
        <translation>die Tabelle ist leer; erwartet wird eine Zeile mit den Namen ihrer Spalten</translation>
    </message>
    <message>
        <source>the template has {0} waypoints, the wayline {1}</source>
        <translation>das Template hat {0} Wegpunkte, die Wayline {1}</translation>
    </message>
    <message>
        <source>the template&apos;s heights are {0}, but the wayline is flown in {1}; the wayline counts here, while a program that starts from the template would fly elsewhere</source>
        <translation>die Höhen des Templates sind {0}, die Wayline wird aber in {1} geflogen; hier zählt die Wayline, ein Programm, das vom Template ausgeht, flöge woanders</translation>
    </message>
    <message>
        <source>the terrain below the airspace departs from its level ground by up to {0} m</source>
        <translation>das Gelände unter dem Luftraum weicht um bis zu {0} m vom ebenen Boden ab</translation>
    </message>
    <message>
        <source>the terrain cannot be brought to home: it has no heights there; give the shift in metres</source>
        <translation>das Gelände kann nicht zum Startplatz gebracht werden: es hat dort keine Höhen; die Verschiebung in Metern angeben</translation>
    </message>
    <message>
        <source>the terrain has no heights below it</source>
        <translation>das Gelände hat darunter keine Höhen</translation>
    </message>
    <message>
        <source>the terrain has no heights below the path (legs concerned: {0}): what is not known is not clear; attach terrain that covers it, or plan it again</source>
        <translation>das Gelände hat unter dem Weg keine Höhen (betroffene Strecken: {0}): was nicht bekannt ist, ist nicht frei; Gelände anhängen, das ihn abdeckt, oder neu planen</translation>
    </message>
    <message>
        <source>the terrain has no heights for a part below it, so its heights are not known</source>
        <translation>das Gelände hat für einen Teil darunter keine Höhen, darum sind ihre Höhen nicht bekannt</translation>
    </message>
    <message>
        <source>the terrain has no heights for a part below the airspace</source>
        <translation>das Gelände hat für einen Teil unter dem Luftraum keine Höhen</translation>
    </message>
    <message>
        <source>the terrain has no heights for a part of the buffer: what lies lower there is not counted</source>
        <translation>das Gelände hat für einen Teil des Puffers keine Höhen: was dort tiefer liegt, zählt nicht</translation>
    </message>
    <message>
        <source>the terrain of the site is not used, as you asked, though {0}; heights count from level ground</source>
        <translation>das Gelände des Standorts wird wie gewünscht nicht benutzt, obwohl gilt: {0}; Höhen zählen vom ebenen Boden</translation>
    </message>
    <message>
        <source>the terrain of the site was made for the place where it is, and would lie wrong elsewhere; take it off first (&apos;site terrain --remove&apos;), and attach it again after the move</source>
        <translation>das Gelände des Standorts gilt für seinen jetzigen Ort und läge anderswo falsch; zuerst abnehmen (&apos;site terrain --remove&apos;) und nach dem Verschieben neu anhängen</translation>
    </message>
    <message>
        <source>the terrain was shifted by {0} m, so that home stands on it</source>
        <translation>das Gelände wurde um {0} m verschoben, damit der Startplatz darauf steht</translation>
    </message>
    <message>
        <source>the time since boot began again</source>
        <translation>die Zeit seit dem Einschalten begann von vorn</translation>
    </message>
    <message>
        <source>the transfer does not get on; a vehicle that restarts again and again, or a bad link</source>
        <translation>die Übertragung kommt nicht voran; ein Fahrzeug, das immer wieder neu startet, oder eine schlechte Verbindung</translation>
    </message>
    <message>
        <source>the vehicle does not answer to file transfer (MAVFTP); take its card out</source>
        <translation>das Fahrzeug antwortet nicht auf Dateiübertragung (MAVFTP); nehmen Sie seine Karte heraus</translation>
    </message>
    <message>
        <source>the vehicle knows no file transfer (MAVFTP); take its card out</source>
        <translation>das Fahrzeug kennt keine Dateiübertragung (MAVFTP); nehmen Sie seine Karte heraus</translation>
    </message>
    <message>
        <source>the vehicle no longer answers</source>
        <translation>das Fahrzeug antwortet nicht mehr</translation>
    </message>
    <message>
        <source>the vehicle refuses: {0}</source>
        <translation>das Fahrzeug lehnt ab: {0}</translation>
    </message>
    <message>
        <source>the video has stopped; it is tried again</source>
        <translation>das Video ist stehen geblieben; es wird wieder versucht</translation>
    </message>
    <message>
        <source>the walls do not close to blocks; each got a depth of {0} m</source>
        <translation>die Wände schließen sich nicht zu Baukörpern; jede bekam eine Tiefe von {0} m</translation>
    </message>
    <message>
        <source>the weights {0} and {1} between {2} and {3} differ; expected ATSP</source>
        <translation>die Gewichte {0} und {1} zwischen {2} und {3} sind verschieden; erwartet: ATSP</translation>
    </message>
    <message>
        <source>the window spans {0} degrees of the cylinder</source>
        <translation>das Fenster umspannt {0} Grad des Zylinders</translation>
    </message>
    <message>
        <source>the zone is {0}; UTM has zones from 1 to 60</source>
        <translation>die Zone ist {0}; UTM hat Zonen von 1 bis 60</translation>
    </message>
    <message>
        <source>there are no logs on the vehicle</source>
        <translation>auf dem Fahrzeug sind keine Logs</translation>
    </message>
    <message>
        <source>there are no records to write</source>
        <translation>es gibt keine Einträge zu schreiben</translation>
    </message>
    <message>
        <source>there are too few points ({0})</source>
        <translation>es gibt zu wenige Punkte ({0})</translation>
    </message>
    <message>
        <source>there are two lines &apos;{0}&apos;</source>
        <translation>es gibt zwei Zeilen &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>there is another file of that name beside the site; rename one</source>
        <translation>neben dem Standort liegt eine andere Datei dieses Namens; eine umbenennen</translation>
    </message>
    <message>
        <source>there is no &apos;{0}&apos;; known are: {1}</source>
        <translation>&apos;{0}&apos; gibt es nicht; bekannt sind: {1}</translation>
    </message>
    <message>
        <source>there is no KML in it; choose another file</source>
        <translation>darin ist kein KML; eine andere Datei wählen</translation>
    </message>
    <message>
        <source>there is no folder or device &apos;{0}&apos;; connected: {1}</source>
        <translation>es gibt keinen Ordner und kein Gerät &apos;{0}&apos;; angeschlossen: {1}</translation>
    </message>
    <message>
        <source>there is no log &apos;{0}&apos; on the vehicle; the newest are: {1}</source>
        <translation>auf dem Fahrzeug gibt es kein Log &apos;{0}&apos;; die neuesten sind: {1}</translation>
    </message>
    <message>
        <source>there is no point {0}</source>
        <translation>es gibt keinen Punkt {0}</translation>
    </message>
    <message>
        <source>there is no square {0} in band {1} of zone {2}</source>
        <translation>das Quadrat {0} gibt es im Band {1} der Zone {2} nicht</translation>
    </message>
    <message>
        <source>there is no square {0} in zone {1}</source>
        <translation>das Quadrat {0} gibt es in Zone {1} nicht</translation>
    </message>
    <message>
        <source>there is no such file or folder</source>
        <translation>diese Datei oder diesen Ordner gibt es nicht</translation>
    </message>
    <message>
        <source>there is no such file; choose an MBTiles or PMTiles file</source>
        <translation>diese Datei gibt es nicht; eine MBTiles- oder PMTiles-Datei wählen</translation>
    </message>
    <message>
        <source>there is no such folder or device; connect it and look again</source>
        <translation>diesen Ordner oder dieses Gerät gibt es nicht; schließen Sie es an und sehen Sie erneut nach</translation>
    </message>
    <message>
        <source>there is no zone &apos;{0}&apos; in the site&apos;s files; those near it are: {1}</source>
        <translation>in den Dateien des Standorts gibt es keine Zone &apos;{0}&apos;; nahe liegen: {1}</translation>
    </message>
    <message>
        <source>there is no zone in this {0} file</source>
        <translation>in dieser {0}-Datei ist keine Zone</translation>
    </message>
    <message>
        <source>there is nothing in it that has a place: no points, lines or areas; choose another file</source>
        <translation>nichts darin hat einen Ort: keine Punkte, Linien oder Flächen; eine andere Datei wählen</translation>
    </message>
    <message>
        <source>there is one photo</source>
        <translation>es gibt ein Foto</translation>
    </message>
    <message>
        <source>these times spoil {0} photos, and any others of this day at least {1}</source>
        <translation>diese Zeiten verderben {0} Fotos, alle anderen dieses Tages mindestens {1}</translation>
    </message>
    <message>
        <source>this folder cannot be made or written into ({0}); name another</source>
        <translation>dieser Ordner kann nicht angelegt oder beschrieben werden ({0}); einen anderen nennen</translation>
    </message>
    <message>
        <source>this looks like the card of a camera (it has a folder DCIM); DJI Pilot 2 reads the card in the remote controller</source>
        <translation>das sieht nach der Karte einer Kamera aus (sie hat einen Ordner DCIM); DJI Pilot 2 liest die Karte in der Fernsteuerung</translation>
    </message>
    <message>
        <source>this place is {0} km from the site; move the site&apos;s zero there first</source>
        <translation>dieser Ort liegt {0} km vom Standort entfernt; zuerst den Nullpunkt dorthin setzen</translation>
    </message>
    <message>
        <source>this source begins on {0} only</source>
        <translation>diese Quelle beginnt erst am {0}</translation>
    </message>
    <message>
        <source>this source ended on {0}: take its present state</source>
        <translation>diese Quelle endete am {0}: den heutigen Stand nehmen</translation>
    </message>
    <message>
        <source>this source is {0} days old, and zones change every month: take its present state, and add it again</source>
        <translation>diese Quelle ist {0} Tage alt, und Zonen ändern sich jeden Monat: den heutigen Stand nehmen und erneut hinzufügen</translation>
    </message>
    <message>
        <source>time goes back in the log, by {0} s at most; what it says was put in order</source>
        <translation>im Log geht die Zeit zurück, um höchstens {0} s; was es sagt, wurde geordnet</translation>
    </message>
    <message>
        <source>time in the air</source>
        <translation>Zeit in der Luft</translation>
    </message>
    <message>
        <source>too few points are seen in several photos</source>
        <translation>zu wenige Punkte sind in mehreren Fotos zu sehen</translation>
    </message>
    <message>
        <source>top of the contingency volume</source>
        <translation>Oberkante des Notfallvolumens</translation>
    </message>
    <message>
        <source>top of the flight geography</source>
        <translation>Oberkante der Fluggeographie</translation>
    </message>
    <message>
        <source>train a model</source>
        <translation>ein Modell trainieren</translation>
    </message>
    <message>
        <source>train a model first</source>
        <translation>zuerst ein Modell trainieren</translation>
    </message>
    <message>
        <source>train a model of it</source>
        <translation>ein Modell davon trainieren</translation>
    </message>
    <message>
        <source>two facades at a right angle, whose glass sees glass</source>
        <translation>zwei Fassaden im rechten Winkel, deren Glas Glas sieht</translation>
    </message>
    <message>
        <source>uninvolved people inside: {0}</source>
        <translation>Unbeteiligte darin: {0}</translation>
    </message>
    <message>
        <source>unpacking</source>
        <translation>auspacken</translation>
    </message>
    <message>
        <source>unseen views</source>
        <translation>ungesehene</translation>
    </message>
    <message>
        <source>unseen views of a model of its photos, expected: {0}</source>
        <translation>ungesehene Ansichten eines Modells aus seinen Fotos, erwartet: {0}</translation>
    </message>
    <message>
        <source>unseen views of a model of the photos, expected: {0} dB</source>
        <translation>ungesehene Ansichten eines Modells aus den Fotos, erwartet: {0} dB</translation>
    </message>
    <message>
        <source>up {0}, {1}</source>
        <translation>über dem Horizont {0}, {1}</translation>
    </message>
    <message>
        <source>uploading</source>
        <translation>wird hochgeladen</translation>
    </message>
    <message>
        <source>value</source>
        <translation>Wert</translation>
    </message>
    <message>
        <source>video: expected a port from 1 to 65535 in &apos;{0}&apos;</source>
        <translation>Video: einen Port von 1 bis 65535 in &apos;{0}&apos; erwartet</translation>
    </message>
    <message>
        <source>video: expected an address without a password, for addresses are kept; found one</source>
        <translation>Video: eine Adresse ohne Passwort erwartet, denn Adressen werden gespeichert; eines gefunden</translation>
    </message>
    <message>
        <source>video: expected rtsp://HOST:PORT/PATH or udp://HOST:PORT, found &apos;{0}&apos;</source>
        <translation>Video: rtsp://HOST:PORT/PFAD oder udp://HOST:PORT erwartet, &apos;{0}&apos; gefunden</translation>
    </message>
    <message>
        <source>viewpoints: {0}</source>
        <translation>Aufnahmepunkte: {0}</translation>
    </message>
    <message>
        <source>views found after</source>
        <translation>Aufnahmen gefunden nach</translation>
    </message>
    <message>
        <source>views held back have {0} dB with a radiance grid, {1} dB with an environment map</source>
        <translation>zurückgehaltene Ansichten haben mit einem Strahlungsgitter {0} dB, mit einem Umgebungsbild {1} dB</translation>
    </message>
    <message>
        <source>views held back have {0} dB with it, {1} dB with splats alone</source>
        <translation>zurückgehaltene Ansichten haben damit {0} dB, mit Splats allein {1} dB</translation>
    </message>
    <message>
        <source>way to brake</source>
        <translation>Bremsweg</translation>
    </message>
    <message>
        <source>waypoints: {0}</source>
        <translation>Wegpunkte: {0}</translation>
    </message>
    <message>
        <source>what answers there is no NTRIP caster</source>
        <translation>was dort antwortet, ist kein NTRIP-Caster</translation>
    </message>
    <message>
        <source>what changes it for a time ({0} entries) is not read</source>
        <translation>was sie zeitweise ändert ({0} Einträge), wird nicht gelesen</translation>
    </message>
    <message>
        <source>what is read back is not what was written (it differs from byte {0} on); the card may be broken: use another one</source>
        <translation>was zurückgelesen wird, ist nicht, was geschrieben wurde (es weicht ab Byte {0} ab); die Karte kann defekt sein: nehmen Sie eine andere</translation>
    </message>
    <message>
        <source>what is there now is not the plan when it is read; do not fly it</source>
        <translation>was jetzt dort ist, liest sich nicht als der Plan; fliegen Sie es nicht</translation>
    </message>
    <message>
        <source>what is to be replaced cannot be copied here first ({0}); nothing was sent</source>
        <translation>was ersetzt werden soll, kann nicht zuerst hierher kopiert werden ({0}); nichts wurde gesendet</translation>
    </message>
    <message>
        <source>what it is</source>
        <translation>was es ist</translation>
    </message>
    <message>
        <source>what only single photos show</source>
        <translation>was nur einzelne Fotos zeigen</translation>
    </message>
    <message>
        <source>when it is active is not read: it counts all the time</source>
        <translation>wann sie aktiv ist, wird nicht gelesen: sie zählt immer</translation>
    </message>
    <message>
        <source>wind, from any side</source>
        <translation>Wind, von jeder Seite</translation>
    </message>
    <message>
        <source>with take-off then, the sun or its mirror image is in {0} of {1} photos, {2} show uneven light, the pilot is blinded for {3} s</source>
        <translation>mit Start dann ist die Sonne oder ihr Spiegelbild in {0} von {1} Fotos, {2} zeigen ungleichmäßiges Licht, der Pilot ist {3} s lang geblendet</translation>
    </message>
    <message>
        <source>with this flight: {0}</source>
        <translation>mit diesem Flug: {0}</translation>
    </message>
    <message>
        <source>without an element in this file, so not written: {0}</source>
        <translation>ohne Element in dieser Datei, also nicht geschrieben: {0}</translation>
    </message>
    <message>
        <source>writing</source>
        <translation>schreiben</translation>
    </message>
    <message>
        <source>writing the coarse model</source>
        <translation>das Grobmodell wird geschrieben</translation>
    </message>
    <message>
        <source>written</source>
        <translation>geschrieben</translation>
    </message>
    <message>
        <source>zone &apos;{0}&apos; differs between files ({1}); name one as FILE/ZONE</source>
        <translation>Zone &apos;{0}&apos; ist in den Dateien verschieden ({1}); eine als DATEI/ZONE nennen</translation>
    </message>
    <message>
        <source>zones: {0}</source>
        <translation>Zonen: {0}</translation>
    </message>
    <message>
        <source>{0}  {1} min  {2}, {3}, photos: {4} of {5}</source>
        <translation>{0}  {1} min  {2}, {3}, Fotos: {4} von {5}</translation>
    </message>
    <message>
        <source>{0} % of the error is where one photo contradicts the others</source>
        <translation>{0} % des Fehlers liegen, wo ein Foto den anderen widerspricht</translation>
    </message>
    <message>
        <source>{0} % of the pixels are next to white</source>
        <translation>{0} % der Pixel sind fast weiß</translation>
    </message>
    <message>
        <source>{0} % of the points lie more than {1} m off the mesh</source>
        <translation>{0} % der Punkte liegen mehr als {1} m neben dem Netz</translation>
    </message>
    <message>
        <source>{0} % of the walls have no points</source>
        <translation>{0} % der Wände haben keine Punkte</translation>
    </message>
    <message>
        <source>{0} % of what the panes mirror is ground and bodies of the site, in the median {1} m away</source>
        <translation>{0} % dessen, was die Scheiben spiegeln, sind Boden und Körper des Standorts, im Median {1} m entfernt</translation>
    </message>
    <message>
        <source>{0} ({1}): {2}</source>
        <translation>{0} ({1}): {2}</translation>
    </message>
    <message>
        <source>{0} (± {1} dB)</source>
        <translation>{0} (± {1} dB)</translation>
    </message>
    <message>
        <source>{0} aircraft at once, all landed after {1} min; they keep {2} m apart, early or late</source>
        <translation>{0} Fluggeräte zugleich, alle gelandet nach {1} min; sie halten {2} m Abstand, ob früh oder spät</translation>
    </message>
    <message>
        <source>{0} batteries</source>
        <translation>{0} Akkus</translation>
    </message>
    <message>
        <source>{0} begin so</source>
        <translation>{0} beginnen so</translation>
    </message>
    <message>
        <source>{0} bytes of the log are no messages and were skipped</source>
        <translation>{0} Bytes des Logs sind keine Nachrichten und wurden übersprungen</translation>
    </message>
    <message>
        <source>{0} bytes of the log are no records and were skipped</source>
        <translation>{0} Bytes des Logs sind keine Datensätze und wurden übersprungen</translation>
    </message>
    <message>
        <source>{0} bytes/s, messages {1}</source>
        <translation>{0} Bytes/s, Nachrichten {1}</translation>
    </message>
    <message>
        <source>{0} is left out: the format {1} has no use for it</source>
        <translation>{0} entfällt: das Format {1} kann damit nichts anfangen</translation>
    </message>
    <message>
        <source>{0} is {1}; the plan was made for {2}</source>
        <translation>{0} ist {1}; der Plan wurde für {2} gemacht</translation>
    </message>
    <message>
        <source>{0} lines of the log make no sense and were skipped</source>
        <translation>{0} Zeilen des Logs ergeben keinen Sinn und wurden übersprungen</translation>
    </message>
    <message>
        <source>{0} m from the airspace</source>
        <translation>{0} m vom Luftraum</translation>
    </message>
    <message>
        <source>{0} may fly in wind of up to {1} m/s, but {2} m/s are stated; wait for less, or take another aircraft</source>
        <translation>{0} darf in Wind bis {1} m/s fliegen, angegeben sind aber {2} m/s; warten Sie auf weniger, oder nehmen Sie ein anderes Fluggerät</translation>
    </message>
    <message>
        <source>{0} more values were left out</source>
        <translation>{0} weitere Werte wurden ausgelassen</translation>
    </message>
    <message>
        <source>{0} of {1} found their place, {2} points, {3} of {4} pairs matched, image points off by {5} px</source>
        <translation>{0} von {1} haben ihren Platz gefunden, {2} Punkte, {3} von {4} Paaren verglichen, Bildpunkte liegen um {5} px daneben</translation>
    </message>
    <message>
        <source>{0} of {1} panes have measured tilts, up to {2} degrees: they shift their glare by up to {3} min</source>
        <translation>{0} von {1} Scheiben haben gemessene Neigungen, bis zu {2} Grad: sie verschieben ihre Blendung um bis zu {3} min</translation>
    </message>
    <message>
        <source>{0} of {1} photos do not say their focal length: it is found with the model</source>
        <translation>{0} von {1} Fotos sagen ihre Brennweite nicht: sie wird mit dem Modell gefunden</translation>
    </message>
    <message>
        <source>{0} of {1} photos do not say where the camera looked, and are left out; name the plan that was flown</source>
        <translation>{0} von {1} Fotos sagen nicht, wohin die Kamera sah, und werden ausgelassen; den geflogenen Plan nennen</translation>
    </message>
    <message>
        <source>{0} of {1} photos do not say {2} and are left out; use the files as the camera wrote them</source>
        <translation>{0} von {1} Fotos nennen nicht {2} und werden ausgelassen; die Dateien so nehmen, wie die Kamera sie schrieb</translation>
    </message>
    <message>
        <source>{0} of {1} photos found no place in the model, the first {2}</source>
        <translation>{0} von {1} Fotos fanden keinen Platz im Modell, das erste: {2}</translation>
    </message>
    <message>
        <source>{0} of {1} photos show glass of the site&apos;s panels, and {2} are needed; are they of this site?</source>
        <translation>{0} von {1} Fotos zeigen Glas der Paneele des Standorts, und {2} sind nötig; sind sie von diesem Standort?</translation>
    </message>
    <message>
        <source>{0} of {1} sides of the building were not seen and are guessed, {2} % of its walls; fly around it before you plan flights there</source>
        <translation>{0} von {1} Seiten des Gebäudes waren nicht zu sehen und sind geraten, {2} % seiner Wände; umfliegen Sie es, bevor Sie dort Flüge planen</translation>
    </message>
    <message>
        <source>{0} of {1} views stand inside buildings opposite or trees, which the scene adds to the site; plan over the {2} beside the photos, which has them, or give the site a look with a wider street</source>
        <translation>{0} von {1} Standpunkten liegen in Gebäuden gegenüber oder in Bäumen, die die Szene dem Standort hinzufügt; über {2} neben den Fotos planen, wo sie enthalten sind, oder dem Standort ein Aussehen mit breiterer Straße geben</translation>
    </message>
    <message>
        <source>{0} photos of {1} x {2} px</source>
        <translation>{0} Fotos mit {1} x {2} px</translation>
    </message>
    <message>
        <source>{0} photos were reported</source>
        <translation>{0} Fotos wurden gemeldet</translation>
    </message>
    <message>
        <source>{0} thermal photos are left out; they were taken together with the others</source>
        <translation>{0} Wärmebilder werden ausgelassen; sie entstanden zusammen mit den anderen</translation>
    </message>
    <message>
        <source>{0} unseen view</source>
        <translation>{0} neue Ansicht</translation>
    </message>
    <message>
        <source>{0} unseen views</source>
        <translation>{0} neue Ansichten</translation>
    </message>
    <message>
        <source>{0} walls, {1} roofs; {2} m2 of walls, of them {3} m2 holes that were closed and {4} m2 guessed</source>
        <translation>{0} Wände, {1} Dächer; {2} m2 Wandfläche, davon {3} m2 geschlossene Lücken und {4} m2 geraten</translation>
    </message>
    <message>
        <source>{0} was {1} and is {2} now</source>
        <translation>{0} war {1} und ist jetzt {2}</translation>
    </message>
    <message>
        <source>{0} waypoints in a route; remote controllers with DJI Fly fail above {1}</source>
        <translation>{0} Wegpunkte in einer Route; Fernsteuerungen mit DJI Fly versagen über {1}</translation>
    </message>
    <message>
        <source>{0} workers ended while they rendered it, perhaps for want of memory</source>
        <translation>{0} Worker endeten beim Rendern, vielleicht aus Mangel an Speicher</translation>
    </message>
    <message>
        <source>{0} {1} min: {2} dB</source>
        <translation>{0} {1} min: {2} dB</translation>
    </message>
    <message>
        <source>{0}, camera {1}</source>
        <translation>{0}, Kamera {1}</translation>
    </message>
    <message>
        <source>{0}, telemetry log</source>
        <translation>{0}, Telemetrie-Log</translation>
    </message>
    <message>
        <source>{0}: facades of unseen views</source>
        <translation>{0}: Fassaden ungesehener Standpunkte</translation>
    </message>
    <message>
        <source>{0}: other programs look for {1} files with names that end in {2}</source>
        <translation>{0}: andere Programme suchen {1}-Dateien mit Namen, die auf {2} enden</translation>
    </message>
    <message>
        <source>{0}: zones {1}, within {2} m of the airspace {3}; SHA-256 {4}</source>
        <translation>{0}: Zonen {1}, bis {2} m vom Luftraum {3}; SHA-256 {4}</translation>
    </message>
    <message>
        <source>{0}: {1} items, read back and equal</source>
        <translation>{0}: {1} Elemente, zurückgelesen und gleich</translation>
    </message>
    <message>
        <source>{0}; another battery would bring {1} dB more</source>
        <translation>{0}; ein weiterer Akku brächte {1} dB mehr</translation>
    </message>
    <message>
        <source>{0}; export it again</source>
        <translation>{0}; erneut exportieren</translation>
    </message>
    <message>
        <source>{0}; the sun or its mirror image is in {1} of {2} photos, {3} show uneven light, the pilot is blinded for {4} s</source>
        <translation>{0}; die Sonne oder ihr Spiegelbild ist in {1} von {2} Fotos, {3} zeigen ungleichmäßiges Licht, der Pilot ist {4} s lang geblendet</translation>
    </message>
    <message>
        <source>{0}; what was flown before is in {1}</source>
        <translation>{0}; was vorher geflogen wurde, steht in {1}</translation>
    </message>
    <message>
        <source>{0}{1} - {2} ({3} {4}, tolerance {5}; costs about {6} s)</source>
        <translation>{0}{1} - {2} ({3} {4}, Toleranz {5}; kostet etwa {6} s)</translation>
    </message>
    <message>
        <source>template and wayline put the waypoint in different places</source>
        <translation>Template und Wayline setzen den Wegpunkt an verschiedene Orte</translation>
    </message>
    <message>
        <source>{0}nothing was recorded: the vehicle sent no positions in flight</source>
        <translation>{0}nichts wurde aufgezeichnet: das Fluggerät sandte im Flug keine Positionen</translation>
    </message>
    <message>
        <source>{0}start actions</source>
        <translation>{0}Startaktionen</translation>
    </message>
    <message>
        <source>{0}waypoint {1}, group {2}</source>
        <translation>{0}Wegpunkt {1}, Gruppe {2}</translation>
    </message>
    <message>
        <source>the actionGroupId occurs twice in one wayline; number the groups from 0</source>
        <translation>die actionGroupId kommt in einer Wayline zweimal vor; die Gruppen von 0 an zählen</translation>
    </message>
    <message>
        <source>the actionGroupId occurs in an earlier wayline, too</source>
        <translation>die actionGroupId kommt auch in einer früheren Wayline vor</translation>
    </message>
    <message>
        <source>the group lacks its id, actionGroupStartIndex or actionGroupEndIndex</source>
        <translation>der Gruppe fehlt id, actionGroupStartIndex oder actionGroupEndIndex</translation>
    </message>
    <message>
        <source>the group has an id or index of 65535, which means unset</source>
        <translation>die Gruppe hat eine id oder einen Index von 65535, was „nicht gesetzt“ heißt</translation>
    </message>
    <message>
        <source>the group acts from waypoint {0} to {1}, but there are waypoints 0 to {2} only</source>
        <translation>die Gruppe wirkt von Wegpunkt {0} bis {1}, es gibt aber nur die Wegpunkte 0 bis {2}</translation>
    </message>
    <message>
        <source>the trigger &apos;{0}&apos; is not one of {1}</source>
        <translation>der Auslöser &apos;{0}&apos; ist keiner von {1}</translation>
    </message>
    <message>
        <source>{0} needs an actionTriggerParam above 0</source>
        <translation>{0} braucht einen actionTriggerParam über 0</translation>
    </message>
    <message>
        <source>a trigger by time or distance that ends where it begins covers no leg; its photos are not counted</source>
        <translation>ein Auslöser nach Zeit oder Strecke, der endet, wo er beginnt, umfasst keine Strecke; seine Fotos zählen nicht</translation>
    </message>
    <message>
        <source>a reachPoint group should act at one waypoint only</source>
        <translation>eine Gruppe mit reachPoint sollte nur an einem Wegpunkt wirken</translation>
    </message>
    <message>
        <source>the group has no actions</source>
        <translation>die Gruppe hat keine Aktionen</translation>
    </message>
    <message>
        <source>{0}, action {1} ({2})</source>
        <translation>{0}, Aktion {1} ({2})</translation>
    </message>
    <message>
        <source>the action has no actionId</source>
        <translation>die Aktion hat keine actionId</translation>
    </message>
    <message>
        <source>the actionId occurs twice in its group; number from 0</source>
        <translation>die actionId kommt in ihrer Gruppe zweimal vor; von 0 an zählen</translation>
    </message>
    <message>
        <source>&apos;{0}&apos; is not a documented action</source>
        <translation>&apos;{0}&apos; ist keine dokumentierte Aktion</translation>
    </message>
    <message>
        <source>the action is for the camera at position {0}, where payloadInfo names none</source>
        <translation>die Aktion gilt der Kamera an Position {0}, wo payloadInfo keine nennt</translation>
    </message>
    <message>
        <source>hover needs a hoverTime above 0</source>
        <translation>hover braucht eine hoverTime über 0</translation>
    </message>
    <message>
        <source>zoom needs a focalLength above 0</source>
        <translation>zoom braucht eine focalLength über 0</translation>
    </message>
    <message>
        <source>the time-lapse has no interval: how many photos it takes is unknown</source>
        <translation>der Zeitraffer hat kein Intervall: Wie viele Fotos er macht, ist nicht bekannt</translation>
    </message>
    <message>
        <source>panoramas are not counted as photos</source>
        <translation>Panoramen zählen nicht als Fotos</translation>
    </message>
    <message>
        <source>; DJI spells it &apos;visable&apos;</source>
        <translation>; DJI schreibt &apos;visable&apos;</translation>
    </message>
    <message>
        <source>&apos;{0}&apos; is not one of the lenses {1}</source>
        <translation>&apos;{0}&apos; ist keine der Linsen {1}</translation>
    </message>
    <message>
        <source>{0} is &apos;{1}&apos;, not an angle</source>
        <translation>{0} ist &apos;{1}&apos;, kein Winkel</translation>
    </message>
    <message>
        <source>aircraftHeading is not in [-180, 180]</source>
        <translation>aircraftHeading liegt nicht in [-180, 180]</translation>
    </message>
    <message>
        <source>rotateYaw has no aircraftHeading</source>
        <translation>rotateYaw hat kein aircraftHeading</translation>
    </message>
    <message>
        <source>&apos;{0}&apos; is no pitch of any gimbal</source>
        <translation>&apos;{0}&apos; ist keine Neigung eines Gimbals</translation>
    </message>
    <message>
        <source>the camera turns from {0} to {1} deg only</source>
        <translation>die Kamera dreht nur von {0} bis {1}°</translation>
    </message>
    <message>
        <source>executeHeightMode is &apos;{0}&apos;; aircraft know {1}</source>
        <translation>executeHeightMode ist &apos;{0}&apos;; Fluggeräte kennen {1}</translation>
    </message>
    <message>
        <source>{0}waypoint {1}</source>
        <translation>{0}Wegpunkt {1}</translation>
    </message>
    <message>
        <source>the wayline has no waypoints</source>
        <translation>die Wayline hat keine Wegpunkte</translation>
    </message>
    <message>
        <source>the wayline has one waypoint; most aircraft want two</source>
        <translation>die Wayline hat einen Wegpunkt; die meisten Fluggeräte wollen zwei</translation>
    </message>
    <message>
        <source>the wayline has {0} waypoints; split it</source>
        <translation>die Wayline hat {0} Wegpunkte; sie teilen</translation>
    </message>
    <message>
        <source>expected indices 0 to {0} in order, found {1} in place {2}</source>
        <translation>erwartet wurden die Indizes 0 bis {0} der Reihe nach, gefunden: {1} an Stelle {2}</translation>
    </message>
    <message>
        <source>the waypoint has no coordinates (longitude,latitude)</source>
        <translation>der Wegpunkt hat keine Koordinaten (Länge,Breite)</translation>
    </message>
    <message>
        <source>latitude and longitude are swapped</source>
        <translation>Breite und Länge sind vertauscht</translation>
    </message>
    <message>
        <source>they look like projected metres, not degrees</source>
        <translation>sie sehen nach projizierten Metern aus, nicht nach Grad</translation>
    </message>
    <message>
        <source>coordinates {0},{1} are not on the globe; {2}</source>
        <translation>die Koordinaten {0},{1} liegen nicht auf der Erde; {2}</translation>
    </message>
    <message>
        <source>coordinates are 0,0, which means that they were never set</source>
        <translation>die Koordinaten sind 0,0, was heißt, dass sie nie gesetzt wurden</translation>
    </message>
    <message>
        <source>the waypoint has no executeHeight</source>
        <translation>der Wegpunkt hat keine executeHeight</translation>
    </message>
    <message>
        <source>the height is outside what aircraft accept</source>
        <translation>die Höhe liegt außerhalb dessen, was Fluggeräte annehmen</translation>
    </message>
    <message>
        <source>the height is close to or below the take-off point; make sure that this is meant</source>
        <translation>die Höhe liegt nahe am Startpunkt oder darunter; sicherstellen, dass das so gemeint ist</translation>
    </message>
    <message>
        <source>the height is above what the law allows in most countries without a permit</source>
        <translation>die Höhe liegt über dem, was das Gesetz in den meisten Ländern ohne Genehmigung erlaubt</translation>
    </message>
    <message>
        <source>neither the waypoint nor the wayline has a speed</source>
        <translation>weder der Wegpunkt noch die Wayline hat eine Geschwindigkeit</translation>
    </message>
    <message>
        <source>the speed must be above 0 and within the format&apos;s range</source>
        <translation>die Geschwindigkeit muss über 0 und im Bereich des Formats liegen</translation>
    </message>
    <message>
        <source>waypointHeadingMode is &apos;{0}&apos;; aircraft know {1}</source>
        <translation>waypointHeadingMode ist &apos;{0}&apos;; Fluggeräte kennen {1}</translation>
    </message>
    <message>
        <source>waypointHeadingAngle is not in [-180, 180]</source>
        <translation>waypointHeadingAngle liegt nicht in [-180, 180]</translation>
    </message>
    <message>
        <source>smoothTransition needs a waypointHeadingAngle</source>
        <translation>smoothTransition braucht einen waypointHeadingAngle</translation>
    </message>
    <message>
        <source>smoothTransition has waypointHeadingAngleEnable 0, so its angle may be ignored</source>
        <translation>smoothTransition hat waypointHeadingAngleEnable 0, ihr Winkel bleibt also vielleicht unbeachtet</translation>
    </message>
    <message>
        <source>towardPOI has no waypointPoiPoint to look at</source>
        <translation>towardPOI hat keinen waypointPoiPoint zum Anblicken</translation>
    </message>
    <message>
        <source>{0}leg {1}-{2}</source>
        <translation>{0}Strecke {1}-{2}</translation>
    </message>
    <message>
        <source>the leg is longer than aircraft accept; put a waypoint in between</source>
        <translation>die Strecke ist länger, als Fluggeräte annehmen; einen Wegpunkt dazwischen setzen</translation>
    </message>
    <message>
        <source>the leg is unusually long</source>
        <translation>die Strecke ist ungewöhnlich lang</translation>
    </message>
    <message>
        <source>the leg is shorter than documented; some aircraft refuse it</source>
        <translation>die Strecke ist kürzer als dokumentiert; manche Fluggeräte lehnen sie ab</translation>
    </message>
    <message>
        <source>waypointTurnMode &apos;{0}&apos; is not known</source>
        <translation>waypointTurnMode &apos;{0}&apos; ist nicht bekannt</translation>
    </message>
    <message>
        <source>the first and the last waypoint must be of a stopping type</source>
        <translation>am ersten und am letzten Wegpunkt muss gehalten werden</translation>
    </message>
    <message>
        <source>{0} needs a waypointTurnDampingDist</source>
        <translation>{0} braucht eine waypointTurnDampingDist</translation>
    </message>
    <message>
        <source>{0} cuts the corner: the path is no polyline</source>
        <translation>{0} schneidet die Ecke: Der Flugweg ist kein Linienzug</translation>
    </message>
    <message>
        <source>waypointTurnDampingDist is ignored where the aircraft stops</source>
        <translation>waypointTurnDampingDist bleibt unbeachtet, wo das Fluggerät hält</translation>
    </message>
    <message>
        <source>the leg is shorter than the turns at its two ends</source>
        <translation>die Strecke ist kürzer als die Kurven an ihren beiden Enden</translation>
    </message>
    <message>
        <source>its distance is {0} m, but its waypoints are {1} m long: was it edited by hand?</source>
        <translation>ihre Länge ist mit {0} m angegeben, ihre Wegpunkte ergeben {1} m: von Hand geändert?</translation>
    </message>
    <message>
        <source>expected the {0} of an unpacked DJI mission, there is none</source>
        <translation>erwartet wurde die {0} einer ausgepackten DJI-Mission, es gibt keine</translation>
    </message>
    <message>
        <source>{0} at the top of the archive, where no DJI program looks; expected both in its folder wpmz; pack it again with that folder</source>
        <translation>{0} oben im Archiv, wo kein DJI-Programm sucht; erwartet wurden beide in seinem Ordner wpmz; mit diesem Ordner neu packen</translation>
    </message>
    <message>
        <source>has a template but no waylines, so what would be flown is not in it; open and save it in DJI Pilot 2</source>
        <translation>hat ein Template, aber keine Waylines, was geflogen würde, steht also nicht darin; in DJI Pilot 2 öffnen und speichern</translation>
    </message>
    <message>
        <source>has {0}; expected wpmz/{1} at the top of the archive; pack it again</source>
        <translation>hat {0}; erwartet wurde wpmz/{1} oben im Archiv; neu packen</translation>
    </message>
    <message>
        <source>no DJI mission; expected wpmz/{0}, found {1}</source>
        <translation>keine DJI-Mission; erwartet wurde wpmz/{0}, gefunden: {1}</translation>
    </message>
    <message>
        <source>aircraft would refuse this mission: {0}</source>
        <translation>Fluggeräte würden diese Mission ablehnen: {0}</translation>
    </message>
    <message>
        <source> ({0} times)</source>
        <translation> ({0}-mal)</translation>
    </message>
    <message>
        <source>; and {0} other kinds</source>
        <translation>; und {0} weitere Arten</translation>
    </message>
    <message>
        <source>the mission follows the ground as the aircraft senses it, so its heights are not in the file; save it with fixed heights</source>
        <translation>die Mission folgt dem Boden, wie ihn das Fluggerät misst, ihre Höhen stehen also nicht in der Datei; sie mit festen Höhen speichern</translation>
    </message>
    <message>
        <source>not readable as XML ({0}); export the mission again</source>
        <translation>nicht als XML lesbar ({0}); die Mission neu exportieren</translation>
    </message>
    <message>
        <source>this is XML, but not a DJI mission; expected kml/Document with the namespace http://www.dji.com/wpmz/1.0.x, found &lt;{0}&gt;</source>
        <translation>das ist XML, aber keine DJI-Mission; erwartet wurde kml/Document mit dem Namensraum http://www.dji.com/wpmz/1.0.x, gefunden: &lt;{0}&gt;</translation>
    </message>
    <message>
        <source>{0} is &apos;{1}&apos;</source>
        <translation>{0} ist &apos;{1}&apos;</translation>
    </message>
    <message>
        <source>waypoint {0}</source>
        <translation>Wegpunkt {0}</translation>
    </message>
    <message>
        <source>before any photo the aircraft stops {0} m above take-off; where it does not, land: it took off from another height than planned</source>
        <translation>vor jedem Foto hält das Fluggerät {0} m über dem Startplatz an; wo nicht, landen: Es ist von einer anderen Höhe als geplant gestartet</translation>
    </message>
    <message>
        <source>before any photo the aircraft stops {0} m above take-off, {1} m above the upper edge of facade &apos;{2}&apos;; where it does not, land: it took off from another height than planned</source>
        <translation>vor jedem Foto hält das Fluggerät {0} m über dem Startplatz an, {1} m über der Oberkante der Fassade &apos;{2}&apos;; wo nicht, landen: Es ist von einer anderen Höhe als geplant gestartet</translation>
    </message>
    <message>
        <source>before any photo the aircraft stops {0} m above take-off, {1} m above the lower edge of facade &apos;{2}&apos;; where it does not, land: it took off from another height than planned</source>
        <translation>vor jedem Foto hält das Fluggerät {0} m über dem Startplatz an, {1} m über der Unterkante der Fassade &apos;{2}&apos;; wo nicht, landen: Es ist von einer anderen Höhe als geplant gestartet</translation>
    </message>
    <message>
        <source>before any photo the aircraft stops {0} m above take-off, {1} m below the upper edge of facade &apos;{2}&apos;; where it does not, land: it took off from another height than planned</source>
        <translation>vor jedem Foto hält das Fluggerät {0} m über dem Startplatz an, {1} m unter der Oberkante der Fassade &apos;{2}&apos;; wo nicht, landen: Es ist von einer anderen Höhe als geplant gestartet</translation>
    </message>
    <message>
        <source>before any photo the aircraft stops {0} m above take-off, {1} m below the lower edge of facade &apos;{2}&apos;; where it does not, land: it took off from another height than planned</source>
        <translation>vor jedem Foto hält das Fluggerät {0} m über dem Startplatz an, {1} m unter der Unterkante der Fassade &apos;{2}&apos;; wo nicht, landen: Es ist von einer anderen Höhe als geplant gestartet</translation>
    </message>
    <message>
        <source>minimum distance (m)</source>
        <translation>Mindestabstand (m)</translation>
    </message>
    <message>
        <source>section step (degrees)</source>
        <translation>Sektorschritt (Grad)</translation>
    </message>
    <message>
        <source>whole panels only</source>
        <translation>nur ganze Scheiben</translation>
    </message>
    <message>
        <source>largest distance (m)</source>
        <translation>größter Abstand (m)</translation>
    </message>
    <message>
        <source>{0} was made for other constraints ({1}); what it states may differ</source>
        <translation>{0} wurde unter anderen Vorgaben gemacht ({1}); seine eigenen Angaben können abweichen</translation>
    </message>
    <message>
        <source>the cameras differ: each plan is seen with its own, what can be covered is that of the first</source>
        <translation>die Kameras unterscheiden sich: Jeder Plan wird mit seiner eigenen gesehen, erreichbar ist, was die erste erreicht</translation>
    </message>
    <message>
        <source>inside {0}</source>
        <translation>in {0}</translation>
    </message>
    <message>
        <source>{0} m too close to {1}</source>
        <translation>{0} m zu nah an {1}</translation>
    </message>
    <message>
        <source>{0} degrees above what the camera sees with the gimbal at its limit</source>
        <translation>{0}° über dem, was die Kamera mit dem Gimbal am Anschlag sieht</translation>
    </message>
    <message>
        <source>{0} degrees below what the camera sees with the gimbal at its limit</source>
        <translation>{0}° unter dem, was die Kamera mit dem Gimbal am Anschlag sieht</translation>
    </message>
    <message>
        <source>{0} m below the lowest flight allowed</source>
        <translation>{0} m unter der niedrigsten erlaubten Flughöhe</translation>
    </message>
    <message>
        <source>{0} m above the ceiling of the airspace</source>
        <translation>{0} m über der Decke des Luftraums</translation>
    </message>
    <message>
        <source>{0} m beyond the sides of the airspace</source>
        <translation>{0} m jenseits der Seiten des Luftraums</translation>
    </message>
    <message>
        <source>{0} m too far away for the largest distance or pixel size allowed</source>
        <translation>{0} m zu weit weg für den größten Abstand oder die gröbste Pixelgröße</translation>
    </message>
    <message>
        <source>hidden by {0}</source>
        <translation>verdeckt von {0}</translation>
    </message>
    <message>
        <source>no way to it was found from home</source>
        <translation>vom Startplatz wurde kein Weg dorthin gefunden</translation>
    </message>
    <message>
        <source>the building</source>
        <translation>dem Gebäude</translation>
    </message>
    <message>
        <source>no-fly volume</source>
        <translation>Flugverbotszone</translation>
    </message>
    <message>
        <source>expected two plans or more to compare, got {0}</source>
        <translation>erwartet wurden zum Vergleichen mindestens zwei Pläne, gefunden: {0}</translation>
    </message>
    <message>
        <source>this plan was made for site &apos;{0}&apos;, the site here is &apos;{1}&apos;; compare plans of one site</source>
        <translation>dieser Plan wurde für den Standort &apos;{0}&apos; gemacht, der Standort hier ist &apos;{1}&apos;; Pläne eines Standorts vergleichen</translation>
    </message>
    <message>
        <source>this plan was made for site &apos;{0}&apos;, the site here is &apos;{1}&apos; at another origin; compare plans of one site</source>
        <translation>dieser Plan wurde für den Standort &apos;{0}&apos; gemacht, der Standort hier ist &apos;{1}&apos; mit anderem Nullpunkt; Pläne eines Standorts vergleichen</translation>
    </message>
    <message>
        <source>this plan is named twice; name each plan once</source>
        <translation>dieser Plan ist zweimal genannt; jeden Plan einmal nennen</translation>
    </message>
    <message>
        <source>expected a plan file, found a mission file, and the first plan does not name an aircraft of the catalogue to read it for; make a plan of it first (&apos;import&apos; with --profile)</source>
        <translation>erwartet wurde eine Plandatei, gefunden eine Missionsdatei, und der erste Plan nennt kein Fluggerät des Katalogs, für das sie zu lesen wäre; zuerst einen Plan daraus machen (&apos;import&apos; mit --profile)</translation>
    </message>
    <message>
        <source>the plan has no {0}, so nothing can be placed on the globe; add --site SITE</source>
        <translation>der Plan hat kein {0}, also lässt sich nichts auf der Erde verorten; den Standort dazu öffnen</translation>
    </message>
    <message>
        <source>the plan was made for the {0} {1}, but the site says {2}; plan again</source>
        <translation>der Plan wurde für {0} {1} gemacht, der Standort sagt aber {2}; neu planen</translation>
    </message>
    <message>
        <source>the plan has no sorties: nothing says which way to fly; plan again, locked views are kept</source>
        <translation>Der Plan hat keine Einsätze: Nichts sagt, auf welchem Weg geflogen wird; neu planen, gesperrte Ansichten bleiben</translation>
    </message>
    <message>
        <source>viewpoint &apos;{0}&apos; is in sortie {1} and again in sortie {2}; expected each viewpoint once</source>
        <translation>Aufnahmepunkt &apos;{0}&apos; gehört zu Einsatz {1} und noch einmal zu Einsatz {2}; erwartet wurde jeder Aufnahmepunkt einmal</translation>
    </message>
    <message>
        <source>{0} viewpoints are in no sortie (the first is &apos;{1}&apos;): their photos would be lost; plan the route again</source>
        <translation>{0} Aufnahmepunkte gehören zu keinem Einsatz (der erste ist &apos;{1}&apos;): Ihre Fotos gingen verloren; die Route neu planen</translation>
    </message>
    <message>
        <source>viewpoint &apos;{0}&apos; needs a gimbal pitch of {1} deg, but {2} turns from {3} to {4} deg and would be stopped there; plan with this camera&apos;s limits</source>
        <translation>Aufnahmepunkt &apos;{0}&apos; braucht eine Gimbalneigung von {1}°, {2} dreht aber von {3} bis {4}° und bliebe dort stehen; mit den Grenzen dieser Kamera planen</translation>
    </message>
    <message>
        <source>its path has {0} points; expected take-off, flight and landing</source>
        <translation>sein Flugweg hat {0} Punkte; erwartet wurden Start, Flug und Landung</translation>
    </message>
    <message>
        <source>its path {0} {1} m from home; expected it to start and end on the ground at home, where heights above take-off are counted from</source>
        <translation>sein Flugweg {0} {1} m vom Startplatz entfernt; erwartet wurde, dass er am Boden am Startplatz beginnt und endet, von wo Höhen über Start zählen</translation>
    </message>
    <message>
        <source>its path {0} with a slanted leg, but aircraft climb and land vertically and would leave the checked path; expected a vertex straight above home</source>
        <translation>sein Flugweg {0} mit einer schrägen Strecke, Fluggeräte steigen und landen aber senkrecht und verließen den geprüften Weg; erwartet wurde eine Ecke genau über dem Startplatz</translation>
    </message>
    <message>
        <source>viewpoint &apos;{0}&apos; is not on the path, or not in the order of viewpoint_ids, so its photo would be lost; plan the route again</source>
        <translation>Aufnahmepunkt &apos;{0}&apos; liegt nicht auf dem Flugweg oder nicht in der Reihenfolge von viewpoint_ids, sein Foto ginge also verloren; die Route neu planen</translation>
    </message>
    <message>
        <source>expected text in UTF-8, found other bytes at offset {0}</source>
        <translation>erwartet wurde Text in UTF-8, an Stelle {0} stehen andere Bytes</translation>
    </message>
    <message>
        <source>expected the column {0} in the first line; it is missing</source>
        <translation>erwartet wurde die Spalte {0} in der ersten Zeile; sie fehlt</translation>
    </message>
    <message>
        <source>{0}, line {1}</source>
        <translation>{0}, Zeile {1}</translation>
    </message>
    <message>
        <source>no table of photos ({0})</source>
        <translation>keine Tabelle von Fotos ({0})</translation>
    </message>
    <message>
        <source>the table has no rows, so there is nothing to fly</source>
        <translation>die Tabelle hat keine Zeilen, also gibt es nichts zu fliegen</translation>
    </message>
    <message>
        <source>a table of photos does not say which way was flown between them; the path is straight from one to the next</source>
        <translation>eine Tabelle von Fotos sagt nicht, auf welchem Weg zwischen ihnen geflogen wurde; der Flugweg geht gerade von einem zum nächsten</translation>
    </message>
    <message>
        <source>no photo ({0}); expected numbers with a decimal point</source>
        <translation>kein Foto ({0}); erwartet wurden Zahlen mit Dezimalpunkt</translation>
    </message>
    <message>
        <source>the return height clears the path only, because the site was not given; check that it clears everything</source>
        <translation>die Rückkehrhöhe ist nur höher als der Flugweg, denn der Standort wurde nicht angegeben; prüfen, ob sie über allem liegt</translation>
    </message>
    <message>
        <source>MAVLink has no heights above the ellipsoid; expected above-takeoff or amsl (its absolute altitude)</source>
        <translation>MAVLink hat keine Höhen über dem Ellipsoid; erwartet wurde above-takeoff oder amsl (seine absolute Höhe)</translation>
    </message>
    <message>
        <source> (and {0} more errors)</source>
        <translation> (und {0} weitere Fehler)</translation>
    </message>
    <message>
        <source>the mission would be refused: {0}</source>
        <translation>die Mission würde abgelehnt: {0}</translation>
    </message>
    <message>
        <source>no mission file that is known; expected a DJI KMZ (or its unpacked folder), a QGroundControl .plan, a QGC WPL .waypoints, or a KML or CSV that Reflight wrote</source>
        <translation>keine bekannte Missionsdatei; erwartet wurde ein DJI-KMZ (oder sein ausgepackter Ordner), ein .plan von QGroundControl, ein .waypoints im Format QGC WPL oder KML oder CSV, das Reflight schrieb</translation>
    </message>
    <message>
        <source>not readable as XML ({0})</source>
        <translation>nicht als XML lesbar ({0})</translation>
    </message>
    <message>
        <source>a KML of another program; it shows places but does not say where photos are taken and with which angles; import the mission file itself</source>
        <translation>ein KML eines anderen Programms; es zeigt Orte, sagt aber nicht, wo mit welchen Winkeln Fotos gemacht werden; die Missionsdatei selbst importieren</translation>
    </message>
    <message>
        <source>damaged: a sortie lacks what Reflight writes ({0}); export it again</source>
        <translation>beschädigt: Einem Einsatz fehlt, was Reflight schreibt ({0}); neu exportieren</translation>
    </message>
    <message>
        <source>item {0}</source>
        <translation>Element {0}</translation>
    </message>
    <message>
        <source>the mission has {0} items, {1} keeps {2}; plan it with shorter sorties</source>
        <translation>die Mission hat {0} Elemente, {1} behält {2}; mit kürzeren Einsätzen planen</translation>
    </message>
    <message>
        <source>item {0} (command {1})</source>
        <translation>Element {0} (Befehl {1})</translation>
    </message>
    <message>
        <source>the position {0}, {1} is not on the globe</source>
        <translation>die Position {0}, {1} liegt nicht auf der Erde</translation>
    </message>
    <message>
        <source>latitude and longitude are 0: ArduPilot takes that for the place where it is, PX4 for one off Africa</source>
        <translation>Breite und Länge sind 0: ArduPilot hält das für den Ort, an dem es ist, PX4 für einen vor Afrika</translation>
    </message>
    <message>
        <source>the altitude is no number</source>
        <translation>die Höhe ist keine Zahl</translation>
    </message>
    <message>
        <source>the hold time is out of range</source>
        <translation>die Haltezeit liegt außerhalb des Erlaubten</translation>
    </message>
    <message>
        <source>DO_DIGICAM_CONTROL releases the camera only where param 5 is 1: no photo here</source>
        <translation>DO_DIGICAM_CONTROL löst die Kamera nur aus, wenn Parameter 5 gleich 1 ist: hier kein Foto</translation>
    </message>
    <message>
        <source>param {0} is NaN, which ArduPilot refuses here</source>
        <translation>Parameter {0} ist NaN, was ArduPilot hier ablehnt</translation>
    </message>
    <message>
        <source>ArduPilot stores whole seconds: the hold of {0} s becomes {1} s</source>
        <translation>ArduPilot speichert ganze Sekunden: Aus {0} s Halt werden {1} s</translation>
    </message>
    <message>
        <source>ArduPilot ignores the yaw of a waypoint (param 4); use CONDITION_YAW before it</source>
        <translation>ArduPilot lässt die Drehung eines Wegpunkts (Parameter 4) unbeachtet; davor CONDITION_YAW verwenden</translation>
    </message>
    <message>
        <source>ArduPilot stores these angles in whole degrees; DO_MOUNT_CONTROL keeps the fraction</source>
        <translation>ArduPilot speichert diese Winkel in ganzen Grad; DO_MOUNT_CONTROL behält die Nachkommastellen</translation>
    </message>
    <message>
        <source>{0} refuses this command in missions</source>
        <translation>{0} lehnt diesen Befehl in Missionen ab</translation>
    </message>
    <message>
        <source>whether {0} takes this command in missions is not known</source>
        <translation>ob {0} diesen Befehl in Missionen annimmt, ist nicht bekannt</translation>
    </message>
    <message>
        <source>{0} does not take the frame {1} here; expected one of {2}</source>
        <translation>{0} nimmt den Bezug (frame) {1} hier nicht an; erwartet wurde einer von {2}</translation>
    </message>
    <message>
        <source>the height counts from terrain: without terrain data ArduPilot does not arm</source>
        <translation>die Höhe zählt ab Gelände: Ohne Geländedaten lässt sich ArduPilot nicht scharf schalten</translation>
    </message>
    <message>
        <source>PX4 takes this command in frame 2 only, found frame {0}</source>
        <translation>PX4 nimmt diesen Befehl nur im Bezug (frame) 2 an, gefunden: {0}</translation>
    </message>
    <message>
        <source>the mission does not begin with a take-off: started on the ground it is refused</source>
        <translation>die Mission beginnt nicht mit einem Start: Vom Boden aus wird sie abgelehnt</translation>
    </message>
    <message>
        <source>some waypoints count their height from take-off, others from sea level</source>
        <translation>manche Wegpunkte zählen ihre Höhe ab Start, andere ab Meeresspiegel</translation>
    </message>
    <message>
        <source>the photo waits for a CONDITION while the aircraft flies on: it is taken on the way, and dropped without a word where the next waypoint is reached first; put the condition before the waypoint</source>
        <translation>das Foto wartet auf eine CONDITION, während das Fluggerät weiterfliegt: Es entsteht unterwegs und entfällt ohne ein Wort, wo der nächste Wegpunkt früher erreicht ist; die Bedingung vor den Wegpunkt setzen</translation>
    </message>
    <message>
        <source>a second photo follows at once; within 0.1 s ArduPilot drops it; put a NAV_DELAY between</source>
        <translation>ein zweites Foto folgt sofort; innerhalb von 0,1 s lässt ArduPilot es fallen; ein NAV_DELAY dazwischen setzen</translation>
    </message>
    <message>
        <source>the waypoint of this photo has no hold: the photo is taken in flight, about 1 m off</source>
        <translation>der Wegpunkt dieses Fotos hat keinen Halt: Das Foto entsteht im Flug, etwa 1 m daneben</translation>
    </message>
    <message>
        <source>the camera turns on in the instant of the photo; put a NAV_DELAY behind the trigger</source>
        <translation>die Kamera dreht im Augenblick des Fotos weiter; hinter den Auslöser ein NAV_DELAY setzen</translation>
    </message>
    <message>
        <source>on a gimbal without pan axis this turns the vehicle to param 3; put it before CONDITION_YAW</source>
        <translation>bei einem Gimbal ohne Schwenkachse dreht das das Fluggerät auf Parameter 3; es vor CONDITION_YAW setzen</translation>
    </message>
    <message>
        <source>the last {0} items follow the last navigation command and may never be done</source>
        <translation>die letzten {0} Elemente folgen auf den letzten Navigationsbefehl und werden vielleicht nie ausgeführt</translation>
    </message>
    <message>
        <source>the waypoints are closer together than the vehicle tells apart</source>
        <translation>die Wegpunkte liegen näher beieinander, als das Fluggerät unterscheidet</translation>
    </message>
    <message>
        <source>items {0} and {1}</source>
        <translation>Elemente {0} und {1}</translation>
    </message>
    <message>
        <source>the mission passes over or under this zone, and fences have no height: it is not in the file&apos;s fence</source>
        <translation>die Mission führt über diese Zone oder unter ihr hindurch, und Zäune haben keine Höhe: Sie ist nicht im Zaun der Datei</translation>
    </message>
    <message>
        <source>spline legs are taken as straight</source>
        <translation>Splines gelten als gerade Strecken</translation>
    </message>
    <message>
        <source>circles are taken as a stop at their centre</source>
        <translation>Kreise gelten als Halt in ihrer Mitte</translation>
    </message>
    <message>
        <source>jumps are not followed: each item counts once</source>
        <translation>Sprüngen wird nicht gefolgt: Jedes Element zählt einmal</translation>
    </message>
    <message>
        <source>nothing says how large the model is: the photos have no positions, and nothing was found below them; measure how far apart two photos were taken, or survey control points, and state it</source>
        <translation>nichts sagt, wie groß das Modell ist: die Fotos haben keine Positionen, und unter ihnen wurde nichts gefunden; messen Sie, wie weit zwei Fotos auseinander aufgenommen wurden, oder Passpunkte, und geben Sie es an</translation>
    </message>
    <message>
        <source>{0}; no top-up is needed, and none was written</source>
        <translation>{0}; kein Ergänzungsflug ist nötig, und keiner wurde geschrieben</translation>
    </message>
    <message>
        <source>{0}; open the project in the window</source>
        <translation>{0}; das Projekt im Fenster öffnen</translation>
    </message>
    <message>
        <source>{0}; or let the embedded renderer be the truth (--truth-rays 0, no --rays)</source>
        <translation>{0}; oder den eingebauten Renderer die Wahrheit sein lassen (--truth-rays 0, kein --rays)</translation>
    </message>
    <message>
        <source>{0}; the site has no panels that they could cover</source>
        <translation>{0}; der Standort hat keine Scheiben, die sie abdecken könnten</translation>
    </message>
    <message>
        <source>{0}[{1}] of a panels file has no point on the facade; give it points_px, or take the line out</source>
        <translation>{0}[{1}] einer Scheibendatei hat keinen Punkt auf der Fassade; ihr points_px geben oder die Linie herausnehmen</translation>
    </message>
    <message>
        <source>{0}item {1}</source>
        <translation>{0}Element {1}</translation>
    </message>
    <message>
        <source>{0}heights above take-off and above sea level are mixed, and home is not known</source>
        <translation>{0}Höhen über Start und über dem Meer sind gemischt, und der Startplatz ist nicht bekannt</translation>
    </message>
    <message>
        <source>the mission &apos;{0}&apos; is {1} km from the site&apos;s home; expected at most {2} km; is it the right site? Imported without one, the mission gets a bare site of its own, to look at it</source>
        <translation>die Mission &apos;{0}&apos; liegt {1} km vom Startplatz des Standorts; erwartet wurden höchstens {2} km; ist es der richtige Standort? Ohne Standort importiert, bekommt die Mission einen leeren eigenen, um sie anzusehen</translation>
    </message>
    <message>
        <source>the leg is vertical, so there is no course to follow: the nose stays as it is</source>
        <translation>die Strecke ist senkrecht, es gibt also keinen Kurs, dem zu folgen wäre: die Nase bleibt, wie sie ist</translation>
    </message>
    <message>
        <source>param {0} is {1}; expected an angle in deg, so it is not followed</source>
        <translation>Parameter {0} ist {1}; erwartet wurde ein Winkel in Grad, er wird also nicht befolgt</translation>
    </message>
    <message>
        <source>param 1 is {0}; expected an angle in deg, so it is not followed</source>
        <translation>Parameter 1 ist {0}; erwartet wurde ein Winkel in Grad, er wird also nicht befolgt</translation>
    </message>
    <message>
        <source>a camera trigger every {0} would take {1} photos on one leg; it is not followed</source>
        <translation>ein Kameraauslöser alle {0} würde auf einer Strecke {1} Fotos machen; er wird nicht befolgt</translation>
    </message>
    <message>
        <source>its home position {0}, {1}, {2} m is not on the globe and is not used</source>
        <translation>ihr Startplatz {0}, {1}, {2} m liegt nicht auf dem Globus und wird nicht verwendet</translation>
    </message>
    <message>
        <source>{0}; they are taken in the order of their numbers</source>
        <translation>{0}; sie gelten in der Reihenfolge ihrer Nummern</translation>
    </message>
    <message>
        <source>its file does not say where it takes off, so home is below its first waypoint, at an assumed height; what depends on that height is only to look at</source>
        <translation>ihre Datei sagt nicht, wo sie startet, also liegt der Startplatz unter ihrem ersten Wegpunkt, in einer angenommenen Höhe; was von dieser Höhe abhängt, ist nur zum Ansehen</translation>
    </message>
    <message>
        <source>the vehicle would refuse this mission: {0}</source>
        <translation>das Fluggerät würde diese Mission ablehnen: {0}</translation>
    </message>
    <message>
        <source>expected viewpoints of the sortie, got {0}</source>
        <translation>erwartet wurden Aufnahmen des Einsatzes, gefunden {0}</translation>
    </message>
    <message>
        <source>{0} of the {1} sections that flights can cover are covered ({2}): plan with more --views, or a --coverage</source>
        <translation>{0} der {1} Sektoren, die Flüge abdecken können, sind abgedeckt ({2}): mit mehr --views oder einer --coverage planen</translation>
    </message>
    <message>
        <source>the site lies where its BIM file says, which is often just the city: compare it with a map, and give its --origin</source>
        <translation>der Standort liegt, wo seine BIM-Datei ihn angibt, was oft nur die Stadt ist: mit einer Karte vergleichen und seinen --origin angeben</translation>
    </message>
    <message>
        <source>a sortie has {0} photos, and {1} keeps items for {2}: it is shared out among more sorties before it is uploaded</source>
        <translation>ein Einsatz hat {0} Fotos, und {1} speichert Punkte für {2}: er wird vor dem Hochladen auf mehr Einsätze verteilt</translation>
    </message>
    <message>
        <source>obstacle sensing does not see glass: the distance kept, {0} m at the least, rests on the position alone; fly with RTK</source>
        <translation>die Hinderniserkennung sieht kein Glas: der gehaltene Abstand, mindestens {0} m, beruht allein auf der Position; mit RTK fliegen</translation>
    </message>
    <message>
        <source>obstacle sensing does not see glass: the distance kept, {0} m at the least, rests on the position alone</source>
        <translation>die Hinderniserkennung sieht kein Glas: der gehaltene Abstand, mindestens {0} m, beruht allein auf der Position</translation>
    </message>
    <message>
        <source>where the sun stands is not looked at: no time is planned (--at)</source>
        <translation>wo die Sonne steht, wird nicht betrachtet: keine Zeit ist geplant (--at)</translation>
    </message>
    <message>
        <source>the sun is below the horizon ({0} degrees) at the planned time</source>
        <translation>die Sonne steht zur geplanten Zeit unter dem Horizont ({0} Grad)</translation>
    </message>
    <message>
        <source>the sun is in no photo at the planned time, and no glass mirrors it into one</source>
        <translation>die Sonne ist zur geplanten Zeit in keinem Foto, und kein Glas spiegelt sie in eines</translation>
    </message>
    <message>
        <source>what cold takes from the batteries is not looked at (--temperature)</source>
        <translation>was Kälte den Akkus nimmt, wird nicht betrachtet (--temperature)</translation>
    </message>
    <message>
        <source>at {0} degrees a battery gives some {1} of its charge, {2} s above the reserve, and the longest sortie takes {3} s: warm the batteries to 20 degrees, or plan shorter sorties with a larger --reserve</source>
        <translation>bei {0} Grad gibt ein Akku etwa {1} seiner Ladung ab, {2} s über der Reserve, und der längste Einsatz dauert {3} s: die Akkus auf 20 Grad wärmen oder mit größerer --reserve kürzere Einsätze planen</translation>
    </message>
    <message>
        <source>at {0} degrees a battery gives some {1} of its charge, and that is enough</source>
        <translation>bei {0} Grad gibt ein Akku etwa {1} seiner Ladung ab, und das reicht</translation>
    </message>
    <message>
        <source>a region of interest of mode {0} is not followed</source>
        <translation>einem Blickziel (region of interest) im Modus {0} wird nicht gefolgt</translation>
    </message>
    <message>
        <source>a photo is taken before the first waypoint, so where is not known; it is left out</source>
        <translation>ein Foto entsteht vor dem ersten Wegpunkt, wo, ist also nicht bekannt; es wird weggelassen</translation>
    </message>
    <message>
        <source>its position means here, but nothing says where that is</source>
        <translation>seine Position heißt „hier“, aber nichts sagt, wo das ist</translation>
    </message>
    <message>
        <source>the position {0}, {1}, {2} m is not on the globe</source>
        <translation>die Position {0}, {1}, {2} m liegt nicht auf der Erde</translation>
    </message>
    <message>
        <source>its height counts from the terrain, which is not in the file; save the mission with heights above take-off or sea level</source>
        <translation>seine Höhe zählt ab Gelände, das nicht in der Datei ist; die Mission mit Höhen über Start oder Meeresspiegel speichern</translation>
    </message>
    <message>
        <source>frame {0} does not place it on the globe</source>
        <translation>der Bezug (frame) {0} legt es nicht auf der Erde fest</translation>
    </message>
    <message>
        <source>this is a Reflight plan already; it needs no import</source>
        <translation>das ist schon ein Plan von Reflight; er braucht keinen Import</translation>
    </message>
    <message>
        <source>no QGroundControl plan; expected a JSON object with fileType &apos;Plan&apos;</source>
        <translation>kein Plan von QGroundControl; erwartet wurde ein JSON-Objekt mit fileType &apos;Plan&apos;</translation>
    </message>
    <message>
        <source>the plan has no mission (it may hold a fence only); save it with its mission</source>
        <translation>der Plan hat keine Mission (vielleicht nur einen Zaun); ihn mit seiner Mission speichern</translation>
    </message>
    <message>
        <source>{0} is {1}; expected {2}; save it with a current QGroundControl</source>
        <translation>{0} ist {1}; erwartet wurde {2}; mit einem aktuellen QGroundControl speichern</translation>
    </message>
    <message>
        <source>mission.items, item {0}</source>
        <translation>mission.items, Element {0}</translation>
    </message>
    <message>
        <source>expected an object, got {0}</source>
        <translation>erwartet wurde ein Objekt, gefunden: {0}</translation>
    </message>
    <message>
        <source>the complex item &apos;{0}&apos; does not hold the items it generates, which only QGroundControl can make; turn it into simple items there</source>
        <translation>das zusammengesetzte Element &apos;{0}&apos; enthält die Elemente nicht, die es erzeugt, und nur QGroundControl kann sie bilden; es dort in einfache Elemente umwandeln</translation>
    </message>
    <message>
        <source>type is &apos;{0}&apos;; expected SimpleItem or ComplexItem</source>
        <translation>type ist &apos;{0}&apos;; erwartet wurde SimpleItem oder ComplexItem</translation>
    </message>
    <message>
        <source>expected numbers for command and frame, got {0} and {1}</source>
        <translation>erwartet wurden Zahlen für command und frame, gefunden: {0} und {1}</translation>
    </message>
    <message>
        <source>expected params to be 7 numbers or null, got {0}</source>
        <translation>erwartet wurden für params 7 Zahlen oder null, gefunden: {0}</translation>
    </message>
    <message>
        <source>expected a list, got {0}</source>
        <translation>erwartet wurde eine Liste, gefunden: {0}</translation>
    </message>
    <message>
        <source>the mission has no waypoint, so there is nothing to fly</source>
        <translation>die Mission hat keinen Wegpunkt, also gibt es nichts zu fliegen</translation>
    </message>
    <message>
        <source>the vehicle would refuse it: {0}</source>
        <translation>das Fluggerät würde sie ablehnen: {0}</translation>
    </message>
    <message>
        <source>expected text, found other bytes at offset {0}</source>
        <translation>erwartet wurde Text, an Stelle {0} stehen andere Bytes</translation>
    </message>
    <message>
        <source>expected &apos;QGC WPL 110&apos; in the first line, found &apos;{0}&apos;</source>
        <translation>erwartet wurde &apos;QGC WPL 110&apos; in der ersten Zeile, gefunden: &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>expected the items numbered from 0 in order, found {0} in place {1}</source>
        <translation>erwartet wurden die Elemente von 0 an der Reihe nach, gefunden: {0} an Stelle {1}</translation>
    </message>
    <message>
        <source>expected {0} columns, found {1}</source>
        <translation>erwartet wurden {0} Spalten, gefunden: {1}</translation>
    </message>
    <message>
        <source>expected numbers with a decimal point ({0})</source>
        <translation>erwartet wurden Zahlen mit Dezimalpunkt ({0})</translation>
    </message>
    <message>
        <source>damaged or no zip archive ({0}); a KMZ is one; copy it again</source>
        <translation>beschädigt oder kein Zip-Archiv ({0}); ein KMZ ist eines; noch einmal kopieren</translation>
    </message>
    <message>
        <source>holds {0} files; expected at most {1}</source>
        <translation>enthält {0} Dateien; erwartet wurden höchstens {1}</translation>
    </message>
    <message>
        <source>holds the path &apos;{0}&apos;, which leads out of it; refused as hostile</source>
        <translation>enthält den Pfad &apos;{0}&apos;, der aus ihr hinausführt; als feindlich abgelehnt</translation>
    </message>
    <message>
        <source>holds &apos;{0}&apos; twice, so which one is meant is unknown; export it again</source>
        <translation>enthält &apos;{0}&apos; zweimal, welche gemeint ist, ist also nicht bekannt; neu exportieren</translation>
    </message>
    <message>
        <source>&apos;{0}&apos; is encrypted; export it without a password</source>
        <translation>&apos;{0}&apos; ist verschlüsselt; ohne Passwort exportieren</translation>
    </message>
    <message>
        <source>&apos;{0}&apos; is damaged ({1}); copy the file again</source>
        <translation>&apos;{0}&apos; ist beschädigt ({1}); die Datei noch einmal kopieren</translation>
    </message>
    <message>
        <source>&apos;{0}&apos; cannot be inflated ({1}); copy the file again</source>
        <translation>&apos;{0}&apos; lässt sich nicht entpacken ({1}); die Datei noch einmal kopieren</translation>
    </message>
    <message>
        <source>&apos;{0}&apos; inflates to more than {1} MiB; refused as hostile</source>
        <translation>&apos;{0}&apos; wird entpackt größer als {1} MiB; als feindlich abgelehnt</translation>
    </message>
    <message>
        <source>{0} photos are left out: the pilot turns the aircraft by hand there</source>
        <translation>{0} Fotos sind weggelassen: Dort dreht der Pilot das Fluggerät von Hand</translation>
    </message>
    <message>
        <source>{0} photos have no gimbal pitch in the file; a gimbal starts level: 0 deg assumed</source>
        <translation>{0} Fotos haben in der Datei keine Gimbalneigung; ein Gimbal beginnt waagerecht: 0° angenommen</translation>
    </message>
    <message>
        <source>the mission has no waypoints</source>
        <translation>die Mission hat keine Wegpunkte</translation>
    </message>
    <message>
        <source>the mission &apos;{0}&apos; reaches {1} km from the origin of the site; expected at most {2} km; a coordinate or a height in it is wrong</source>
        <translation>die Mission &apos;{0}&apos; reicht {1} km vom Nullpunkt des Standorts weg; erwartet wurden höchstens {2} km; eine Koordinate oder Höhe darin ist falsch</translation>
    </message>
    <message>
        <source>its heights are above take-off and were counted from the site&apos;s home</source>
        <translation>ihre Höhen sind über Start und wurden ab dem Startplatz des Standorts gezählt</translation>
    </message>
    <message>
        <source>its heights are above sea level and were brought to the ellipsoid with EGM96</source>
        <translation>ihre Höhen sind über dem Meer und wurden mit EGM96 auf das Ellipsoid gebracht</translation>
    </message>
    <message>
        <source>it was planned for a take-off {0} m from the site&apos;s home; the way there is not the planned one</source>
        <translation>sie wurde für einen Start {0} m vom Startplatz des Standorts geplant; der Weg dorthin ist nicht der geplante</translation>
    </message>
    <message>
        <source>its take-off point lies {0} m above the site&apos;s home, so counted from home all its heights are off by that</source>
        <translation>ihr Startpunkt liegt {0} m über dem Startplatz des Standorts, ab diesem gezählt sind also alle ihre Höhen um so viel falsch</translation>
    </message>
    <message>
        <source>its take-off point lies {0} m below the site&apos;s home, so counted from home all its heights are off by that</source>
        <translation>ihr Startpunkt liegt {0} m unter dem Startplatz des Standorts, ab diesem gezählt sind also alle ihre Höhen um so viel falsch</translation>
    </message>
    <message>
        <source>the mission ends hovering at its last waypoint; the way home is the pilot&apos;s and not in the path</source>
        <translation>die Mission endet schwebend an ihrem letzten Wegpunkt; der Heimweg ist Sache des Piloten und nicht im Flugweg</translation>
    </message>
    <message>
        <source>no mission can be made of this plan: {0}</source>
        <translation>aus diesem Plan lässt sich keine Mission machen: {0}</translation>
    </message>
    <message>
        <source>{0} planned photos and {1} in the file are too many to compare one by one; compare smaller plans</source>
        <translation>{0} geplante Fotos und {1} in der Datei sind zu viele für einen Vergleich eins zu eins; kleinere Pläne vergleichen</translation>
    </message>
    <message>
        <source>the site file of &apos;{0}&apos; has changed since this plan was made; what the mission takes from it (return height, fences) is as it is now</source>
        <translation>die Standortdatei von &apos;{0}&apos; hat sich geändert, seit dieser Plan gemacht wurde; was die Mission daraus nimmt (Rückkehrhöhe, Zäune), ist wie jetzt</translation>
    </message>
    <message>
        <source>this plan is not ready to fly ({0} findings of the pre-flight check, the first: {1})</source>
        <translation>dieser Plan ist nicht flugbereit ({0} Befunde der Vorflugprüfung, der erste: {1})</translation>
    </message>
    <message>
        <source>{0} keeps the items of about {1} photos, but a sortie of this plan has {2}; the same views were shared out among {3} sorties for these files</source>
        <translation>{0} behält die Elemente von etwa {1} Fotos, ein Einsatz dieses Plans hat aber {2}; dieselben Aufnahmen wurden für diese Dateien auf {3} Einsätze verteilt</translation>
    </message>
    <message>
        <source>this mission file is named twice; name the file of each sortie once</source>
        <translation>diese Missionsdatei ist zweimal genannt; die Datei jedes Einsatzes einmal nennen</translation>
    </message>
    <message>
        <source>the return height is below the highest point of the site: a returning aircraft may hit it; expected {0} m or more above take-off, got {1} m, and {2} m keep {3} m from everything</source>
        <translation>die Rückkehrhöhe liegt unter dem höchsten Punkt des Standorts: Ein heimkehrendes Fluggerät kann dagegen fliegen; erwartet wurden mindestens {0} m über Start, gefunden: {1} m, und {2} m halten zu allem {3} m Abstand</translation>
    </message>
    <message>
        <source>the file has {0} rally points, which belong to a site and not to a plan; mark them there</source>
        <translation>Die Datei hat {0} Rally-Punkte, die zu einem Standort gehören und nicht zu einem Plan; dort setzen</translation>
    </message>
    <message>
        <source>the file states {0} s for its route, and by what it tells the aircraft to do it takes {1} s; with the way there and back, take-off and landing the flight takes {2} s</source>
        <translation>die Datei gibt für ihre Route {0} s an, und nach dem, was sie dem Fluggerät aufträgt, dauert sie {1} s; mit Hin- und Rückweg, Start und Landung dauert der Flug {2} s</translation>
    </message>
    <message>
        <source>{0} photos that the imported mission takes in passing are stops in these files, so the sortie takes {1} s instead of {2} s</source>
        <translation>{0} Fotos, die die importierte Mission im Vorbeiflug macht, sind in diesen Dateien Halte, sodass der Einsatz {1} s statt {2} s dauert</translation>
    </message>
    <message>
        <source>starts</source>
        <translation>beginnt</translation>
    </message>
    <message>
        <source>ends</source>
        <translation>endet</translation>
    </message>
    <message>
        <source>moved</source>
        <translation>verschoben</translation>
    </message>
    <message>
        <source>deleted</source>
        <translation>gelöscht</translation>
    </message>
    <message>
        <source>inside</source>
        <translation>innen</translation>
    </message>
    <message>
        <source>occlusion</source>
        <translation>Verdeckung</translation>
    </message>
    <message>
        <source>facade</source>
        <translation>Fassade</translation>
    </message>
    <message>
        <source>obstacle</source>
        <translation>Hindernis</translation>
    </message>
    <message>
        <source>panel</source>
        <translation>Scheibe</translation>
    </message>
    <message>
        <source>panels</source>
        <translation>Scheiben</translation>
    </message>
    <message>
        <source>zone</source>
        <translation>Zone</translation>
    </message>
    <message>
        <source>building</source>
        <translation>Gebäude</translation>
    </message>
    <message>
        <source>home</source>
        <translation>Startplatz</translation>
    </message>
    <message>
        <source>airspace</source>
        <translation>Luftraum</translation>
    </message>
    <message>
        <source>east</source>
        <translation>Ost</translation>
    </message>
    <message>
        <source>north</source>
        <translation>Nord</translation>
    </message>
    <message>
        <source>up</source>
        <translation>Höhe</translation>
    </message>
    <message>
        <source>obstacle &apos;{0}&apos;</source>
        <translation>Hindernis &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>panel &apos;{0}&apos;</source>
        <translation>Scheibe &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>no-fly volume &apos;{0}&apos;</source>
        <translation>Flugverbotszone &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>the building &apos;{0}&apos;</source>
        <translation>dem Gebäude &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>{0} deg</source>
        <translation>{0}°</translation>
    </message>
    <message>
        <source>{0} viewpoints</source>
        <translation>{0} Aufnahmepunkte</translation>
    </message>
    <message>
        <source>{0} views</source>
        <translation>{0} Aufnahmen</translation>
    </message>
    <message>
        <source>{0} sections</source>
        <translation>{0} Sektoren</translation>
    </message>
    <message>
        <source>{0} photos</source>
        <translation>{0} Fotos</translation>
    </message>
    <message>
        <source>{0} findings</source>
        <translation>{0} Befunde</translation>
    </message>
    <message>
        <source>{0} not reached</source>
        <translation>{0} nicht erreicht</translation>
    </message>
    <message>
        <source>{0} reached, but the camera did not answer</source>
        <translation>{0} erreicht, aber die Kamera antwortete nicht</translation>
    </message>
    <message>
        <source>{0} photographed, but the camera&apos;s report was lost</source>
        <translation>{0} fotografiert, aber die Meldung der Kamera ging verloren</translation>
    </message>
    <message>
        <source>{0} in sorties that were not flown</source>
        <translation>{0} in Einsätzen, die nicht geflogen wurden</translation>
    </message>
    <message>
        <source>{0} of the {1} sections that flights can cover are covered ({2}): plan more views, or a share of coverage</source>
        <translation>{0} der {1} Sektoren, die Flüge abdecken können, sind abgedeckt ({2}): mehr Aufnahmen planen oder einen Anteil der Abdeckung</translation>
    </message>
    <message>
        <source>{0} photographed from too far away</source>
        <translation>{0} aus zu großer Entfernung aufgenommen</translation>
    </message>
    <message>
        <source>{0} where the photo looks elsewhere</source>
        <translation>{0} mit einem Foto, das woandershin blickt</translation>
    </message>
    <message>
        <source>{0} not reached before the flight ended</source>
        <translation>{0} nicht erreicht, ehe der Flug endete</translation>
    </message>
    <message>
        <source>{0} not reached because the flight was broken off by Return</source>
        <translation>{0} nicht erreicht, weil der Flug mit Heimkehr abgebrochen wurde</translation>
    </message>
    <message>
        <source>{0} not reached because the flight was broken off by Land</source>
        <translation>{0} nicht erreicht, weil der Flug mit Landen abgebrochen wurde</translation>
    </message>
    <message>
        <source>{0} not reached because the flight was broken off for low battery</source>
        <translation>{0} nicht erreicht, weil der Flug wegen schwachen Akkus abgebrochen wurde</translation>
    </message>
    <message>
        <source>{0} not reached because the flight was broken off for the lost link</source>
        <translation>{0} nicht erreicht, weil der Flug wegen verlorener Funkverbindung abgebrochen wurde</translation>
    </message>
    <message>
        <source>{0} not reached because the flight was broken off for the lost remote control</source>
        <translation>{0} nicht erreicht, weil der Flug wegen verlorener Fernsteuerung abgebrochen wurde</translation>
    </message>
    <message>
        <source>{0} not reached because the flight was broken off at the fence</source>
        <translation>{0} nicht erreicht, weil der Flug am Geofence abgebrochen wurde</translation>
    </message>
    <message>
        <source>{0} not reached because the pilot took over by hand</source>
        <translation>{0} nicht erreicht, weil der Pilot von Hand übernahm</translation>
    </message>
    <message>
        <source>{0} not reached because the motors stopped in the air</source>
        <translation>{0} nicht erreicht, weil die Motoren in der Luft ausgingen</translation>
    </message>
    <message>
        <source>{0} after the end of the record in the air</source>
        <translation>{0} nach dem Ende der Aufzeichnung in der Luft</translation>
    </message>
    <message>
        <source>{0} where the record does not tell the aircraft&apos;s place</source>
        <translation>{0} ohne Ort des Fluggeräts in der Aufzeichnung</translation>
    </message>
    <message>
        <source>minimum distance (m) {0} instead of {1}</source>
        <translation>Mindestabstand (m) {0} statt {1}</translation>
    </message>
    <message>
        <source>section step (degrees) {0} instead of {1}</source>
        <translation>Sektorschritt (Grad) {0} statt {1}</translation>
    </message>
    <message>
        <source>occlusion {0} instead of {1}</source>
        <translation>Verdeckung {0} statt {1}</translation>
    </message>
    <message>
        <source>whole panels only {0} instead of {1}</source>
        <translation>nur ganze Scheiben {0} statt {1}</translation>
    </message>
    <message>
        <source>largest distance (m) {0} instead of {1}</source>
        <translation>größter Abstand (m) {0} statt {1}</translation>
    </message>
    <message>
        <source>expected {0} of length {1}, got {2}</source>
        <translation>erwartet wurde {0} der Länge {1}, gefunden: {2}</translation>
    </message>
    <message>
        <source>missing required field &apos;{0}&apos;</source>
        <translation>das verlangte Feld &apos;{0}&apos; fehlt</translation>
    </message>
    <message>
        <source>object contains unknown field &apos;{0}&apos;</source>
        <translation>das Feld &apos;{0}&apos; ist nicht bekannt</translation>
    </message>
    <message>
        <source>invalid enum value {0}</source>
        <translation>kein bekannter Wert: {0}</translation>
    </message>
    <message>
        <source>black</source>
        <translation>schwarz</translation>
    </message>
    <message>
        <source>white</source>
        <translation>weiß</translation>
    </message>
    <message>
        <source>longer</source>
        <translation>länger</translation>
    </message>
    <message>
        <source>shorter</source>
        <translation>kürzer</translation>
    </message>
    <message>
        <source>number</source>
        <translation>Zahl</translation>
    </message>
    <message>
        <source>whole number</source>
        <translation>ganze Zahl</translation>
    </message>
    <message>
        <source>the terrain of the site was made for the place where it is, and would lie wrong elsewhere; take it off first (Site &gt; Terrain), and attach it again after the move</source>
        <translation>das Gelände des Standorts gilt für seinen jetzigen Ort und läge anderswo falsch; zuerst abnehmen (Standort &gt; Gelände) und nach dem Verschieben neu anhängen</translation>
    </message>
    <message>
        <source>terrain and site differ by {0} m at home: where the ground is level there, one of them is wrong; the terrain can be brought to home</source>
        <translation>Gelände und Standort unterscheiden sich am Startplatz um {0} m: ist der Boden dort eben, stimmt eines von beiden nicht; das Gelände kann zum Startplatz gebracht werden</translation>
    </message>
    <message>
        <source>the picture is distorted, and splats are rendered without distortion; make a data set of it (Photos tab)</source>
        <translation>das Bild ist verzeichnet, und Splats werden ohne Verzeichnung gerendert; daraus einen Datensatz anlegen (Fotos)</translation>
    </message>
    <message>
        <source>expected a folder of panels files (*.json); found none</source>
        <translation>erwartet wird ein Ordner mit Scheibendateien (*.json); gefunden keine</translation>
    </message>
    <message>
        <source>text</source>
        <translation>Text</translation>
    </message>
    <message>
        <source>list</source>
        <translation>Liste</translation>
    </message>
    <message>
        <source>object</source>
        <translation>Objekt</translation>
    </message>
    <message>
        <source>nothing</source>
        <translation>nichts</translation>
    </message>
    <message>
        <source>true/false</source>
        <translation>true/false</translation>
    </message>
    <message>
        <source>a .toml file</source>
        <translation>eine .toml-Datei</translation>
    </message>
    <message>
        <source>No such file or directory</source>
        <translation>Datei oder Ordner nicht gefunden</translation>
    </message>
    <message>
        <source>Permission denied</source>
        <translation>Zugriff verweigert</translation>
    </message>
    <message>
        <source>Is a directory</source>
        <translation>ist ein Ordner</translation>
    </message>
    <message>
        <source>Not a directory</source>
        <translation>ist kein Ordner</translation>
    </message>
    <message>
        <source>File exists</source>
        <translation>Datei ist schon da</translation>
    </message>
    <message>
        <source>File name too long</source>
        <translation>Dateiname zu lang</translation>
    </message>
    <message>
        <source>Invalid argument</source>
        <translation>ungültige Angabe</translation>
    </message>
    <message>
        <source>No space left on device</source>
        <translation>kein Platz mehr auf dem Datenträger</translation>
    </message>
    <message>
        <source>Read-only file system</source>
        <translation>schreibgeschützter Datenträger</translation>
    </message>
    <message>
        <source>Input/output error</source>
        <translation>Fehler beim Lesen oder Schreiben</translation>
    </message>
    <message>
        <source>Disk quota exceeded</source>
        <translation>Speicherkontingent erschöpft</translation>
    </message>
    <message>
        <source>[Errno {0}] {1}</source>
        <translation>[Errno {0}] {1}</translation>
    </message>
    <message>
        <source>Expecting value</source>
        <translation>ein Wert wird erwartet</translation>
    </message>
    <message>
        <source>Expecting property name enclosed in double quotes</source>
        <translation>ein Name in Anführungszeichen wird erwartet</translation>
    </message>
    <message>
        <source>Expecting &apos;,&apos; delimiter</source>
        <translation>ein Komma wird erwartet</translation>
    </message>
    <message>
        <source>Expecting &apos;:&apos; delimiter</source>
        <translation>ein Doppelpunkt wird erwartet</translation>
    </message>
    <message>
        <source>Extra data</source>
        <translation>überzählige Zeichen</translation>
    </message>
    <message>
        <source>template.kml and waylines.wpml</source>
        <translation>template.kml und waylines.wpml</translation>
    </message>
    <message>
        <source>views</source>
        <translation>Aufnahmen</translation>
    </message>
    <message>
        <source>batteries</source>
        <translation>Akkus</translation>
    </message>
    <message>
        <source>coverage</source>
        <translation>Abdeckung</translation>
    </message>
    <message>
        <source>seed</source>
        <translation>Startwert</translation>
    </message>
    <message>
        <source> and </source>
        <translation> und </translation>
    </message>
    <message>
        <source>done</source>
        <translation>erledigt</translation>
    </message>
    <message>
        <source>denied</source>
        <translation>verweigert</translation>
    </message>
    <message>
        <source>failed</source>
        <translation>misslungen</translation>
    </message>
    <message>
        <source>cancelled</source>
        <translation>abgebrochen</translation>
    </message>
    <message>
        <source>pausing</source>
        <translation>anhalten</translation>
    </message>
    <message>
        <source>arming</source>
        <translation>scharfschalten</translation>
    </message>
    <message>
        <source>mission</source>
        <translation>Mission</translation>
    </message>
    <message>
        <source>geofence</source>
        <translation>Geofence</translation>
    </message>
    <message>
        <source>{0}: done</source>
        <translation>{0}: erledigt</translation>
    </message>
    <message>
        <source>wind</source>
        <translation>Wind</translation>
    </message>
    <message>
        <source>multipath</source>
        <translation>Mehrwegeempfang</translation>
    </message>
    <message>
        <source>Fresnel</source>
        <translation>Fresnel</translation>
    </message>
    <message>
        <source>curvature</source>
        <translation>Wölbung</translation>
    </message>
    <message>
        <source>shadow</source>
        <translation>Schatten</translation>
    </message>
    <message>
        <source>vignetting</source>
        <translation>Randabdunklung</translation>
    </message>
    <message>
        <source>noise</source>
        <translation>Rauschen</translation>
    </message>
    <message>
        <source>px</source>
        <translation>px</translation>
    </message>
    <message>
        <source>sortie {0}</source>
        <translation>Einsatz {0}</translation>
    </message>
    <message>
        <source>{0}, at least {1}</source>
        <translation>{0}, mindestens {1}</translation>
    </message>
    <message>
        <source>{0}, at most {1}</source>
        <translation>{0}, höchstens {1}</translation>
    </message>
    <message>
        <source>the plan was made for this site file</source>
        <translation>der Plan wurde für diese Standortdatei gemacht</translation>
    </message>
    <message>
        <source>the plan was made for site &apos;{0}&apos;, this is &apos;{1}&apos;; take its own site file</source>
        <translation>der Plan wurde für den Standort &apos;{0}&apos; gemacht, dies ist &apos;{1}&apos;; seine eigene Standortdatei nehmen</translation>
    </message>
    <message>
        <source>the site file has changed since this plan was made; what follows is measured on the file as it is now</source>
        <translation>die Standortdatei hat sich geändert, seit dieser Plan gemacht wurde; was folgt, ist an der jetzigen Datei gemessen</translation>
    </message>
    <message>
        <source>the plan was made for a site of this name, &apos;{0}&apos;; it does not say for which state of its file</source>
        <translation>der Plan wurde für einen Standort dieses Namens gemacht, &apos;{0}&apos;; für welchen Stand der Datei, sagt er nicht</translation>
    </message>
    <message>
        <source>{0} viewpoints are not in exactly one sortie (the first is &apos;{1}&apos;); plan the route again</source>
        <translation>{0} Aufnahmepunkte gehören nicht zu genau einem Einsatz (der erste ist &apos;{1}&apos;); die Route neu planen</translation>
    </message>
    <message>
        <source>the plan has no sorties; plan the route first</source>
        <translation>der Plan hat keine Einsätze; zuerst die Route planen</translation>
    </message>
    <message>
        <source>{0} viewpoints, each in one of {1} sorties</source>
        <translation>{0} Aufnahmepunkte, jeder in einem von {1} Einsätzen</translation>
    </message>
    <message>
        <source>the path has {0} points; expected one from home to home</source>
        <translation>der Flugweg hat {0} Punkte; erwartet wurde einer von Startplatz zu Startplatz</translation>
    </message>
    <message>
        <source>not all viewpoints are vertices of the path, in order; plan the route again</source>
        <translation>nicht alle Aufnahmepunkte sind der Reihe nach Ecken des Flugwegs; die Route neu planen</translation>
    </message>
    <message>
        <source>the path {0} {1} m from home; expected it to run from take-off to landing at home</source>
        <translation>der Flugweg {0} {1} m vom Startplatz entfernt; erwartet wurde ein Weg vom Start bis zur Landung am Startplatz</translation>
    </message>
    <message>
        <source>the camera would stop at its limit and look elsewhere</source>
        <translation>die Kamera bliebe an ihrem Anschlag stehen und blickte woandershin</translation>
    </message>
    <message>
        <source>lowest gimbal pitch</source>
        <translation>kleinste Gimbalneigung</translation>
    </message>
    <message>
        <source>highest gimbal pitch</source>
        <translation>größte Gimbalneigung</translation>
    </message>
    <message>
        <source>viewpoints whose heading is not in (-180, 180]</source>
        <translation>Aufnahmepunkte, deren Richtung nicht in (-180, 180] liegt</translation>
    </message>
    <message>
        <source>mission files need it there</source>
        <translation>Missionsdateien brauchen sie dort</translation>
    </message>
    <message>
        <source>waypoints of {0}</source>
        <translation>Wegpunkte von {0}</translation>
    </message>
    <message>
        <source>split the flight into more sorties</source>
        <translation>den Flug auf mehr Einsätze aufteilen</translation>
    </message>
    <message>
        <source>expected wind</source>
        <translation>erwarteter Wind</translation>
    </message>
    <message>
        <source>duration with the battery reserve kept</source>
        <translation>Dauer mit der einbehaltenen Akkureserve</translation>
    </message>
    <message>
        <source>fly fewer views per sortie</source>
        <translation>weniger Aufnahmen je Einsatz fliegen</translation>
    </message>
    <message>
        <source>stated duration</source>
        <translation>angegebene Dauer</translation>
    </message>
    <message>
        <source>it is too optimistic for this path</source>
        <translation>sie ist für diesen Flugweg zu knapp</translation>
    </message>
    <message>
        <source>stated length off by</source>
        <translation>Abweichung der angegebenen Länge</translation>
    </message>
    <message>
        <source>shortest time between photos</source>
        <translation>kürzeste Zeit zwischen zwei Fotos</translation>
    </message>
    <message>
        <source>the camera would miss photos; hover longer before each</source>
        <translation>die Kamera würde Fotos auslassen; vor jedem länger schweben</translation>
    </message>
    <message>
        <source>hover before each photo</source>
        <translation>Schweben vor jedem Foto</translation>
    </message>
    <message>
        <source>1 to 2 s keep photos sharp</source>
        <translation>1 bis 2 s halten Fotos scharf</translation>
    </message>
    <message>
        <source>coarsest pixel on a covered panel: {0} mm</source>
        <translation>gröbstes Pixel auf einer abgedeckten Scheibe: {0} mm</translation>
    </message>
    <message>
        <source>{0}, no limit set</source>
        <translation>{0}, keine Grenze gesetzt</translation>
    </message>
    <message>
        <source>finest pixel on a panel, of the coarsest photo</source>
        <translation>feinstes Pixel auf einer Scheibe, beim gröbsten Foto</translation>
    </message>
    <message>
        <source>    {0}</source>
        <translation>    {0}</translation>
    </message>
    <message>
        <source>  {0} [{1}]: {2}; {3}; {4}</source>
        <translation>  {0} [{1}]: {2}; {3}; {4}</translation>
    </message>
    <message>
        <source> (remote ID: {0})</source>
        <translation> (Remote ID: {0})</translation>
    </message>
    <message>
        <source>&apos;O&apos; is east in German and west in French; write E or W</source>
        <translation>&apos;O&apos; ist deutsch Ost und französisch West; E oder W schreiben</translation>
    </message>
    <message>
        <source>&apos;{0}&apos; has 60 or more minutes or seconds</source>
        <translation>&apos;{0}&apos; hat 60 oder mehr Minuten oder Sekunden</translation>
    </message>
    <message>
        <source>&apos;{0}&apos; has decimals before its last part</source>
        <translation>&apos;{0}&apos; hat Nachkommastellen vor dem letzten Teil</translation>
    </message>
    <message>
        <source>&apos;{0}&apos; is no band of UTM; bands are C to X without I and O</source>
        <translation>&apos;{0}&apos; ist kein UTM-Band; Bänder sind C bis X ohne I und O</translation>
    </message>
    <message>
        <source>&apos;{0}&apos; is no place; expected latitude and longitude (22.3372, 114.2636, or 22°20&apos;14&quot; N 114°15&apos;49&quot; E), UTM (50Q 218155 2472500) or MGRS (50Q KK 18155 72500)</source>
        <translation>&apos;{0}&apos; ist kein Ort; erwartet werden Breite und Länge (22.3372, 114.2636 oder 22°20&apos;14&quot; N 114°15&apos;49&quot; E), UTM (50Q 218155 2472500) oder MGRS (50Q KK 18155 72500)</translation>
    </message>
    <message>
        <source>, {0} dB on facades of {1}</source>
        <translation>, {0} dB auf Fassaden ({1})</translation>
    </message>
    <message>
        <source>, {0} dB on {1}</source>
        <translation>, {0} dB ({1})</translation>
    </message>
    <message>
        <source>1:1 is not enough: it can fall {0} m far, the buffer is {1} m</source>
        <translation>1:1 reicht nicht: es kann {0} m weit fallen, der Puffer hat {1} m</translation>
    </message>
    <message>
        <source>; is the longitude written first?</source>
        <translation>; steht die Länge vorn?</translation>
    </message>
    <message>
        <source>; their base stands {0} km away</source>
        <translation>; ihre Basis steht {0} km entfernt</translation>
    </message>
    <message>
        <source>; where their base stands is not known</source>
        <translation>; wo ihre Basis steht, ist nicht bekannt</translation>
    </message>
    <message>
        <source>; with take-off at {0} it would be {1} s</source>
        <translation>; mit Start um {0} wären es {1} s</translation>
    </message>
    <message>
        <source>A filled draft: the operator checks every number before it is used. It is no permission.</source>
        <translation>Ein ausgefüllter Entwurf: der Betreiber prüft jede Zahl vor der Verwendung. Er ist keine Genehmigung.</translation>
    </message>
    <message>
        <source>A flight with one battery, from take-off to landing.</source>
        <translation>Ein Flug mit einem Akku, vom Start bis zur Landung.</translation>
    </message>
    <message>
        <source>A part of the hemisphere of directions before a panel. A photo covers the section that it is taken from; glass looks different from each.</source>
        <translation>Ein Teil der Halbkugel von Richtungen vor einer Scheibe. Ein Foto deckt den Sektor ab, aus dem es aufgenommen ist; aus jedem sieht Glas anders aus.</translation>
    </message>
    <message>
        <source>A place in the air with heading and gimbal pitch, from where one photo is taken.</source>
        <translation>Ein Ort in der Luft mit Richtung und Gimbalneigung, von dem aus ein Foto aufgenommen wird.</translation>
    </message>
    <message>
        <source>A place where the aircraft may land instead of home when it returns.</source>
        <translation>Ein Ort, an dem das Fluggerät bei der Rückkehr statt am Startplatz landen darf.</translation>
    </message>
    <message>
        <source>A small blurred ellipse in space. A model is made of many, and of the light that panes mirror.</source>
        <translation>Eine kleine unscharfe Ellipse im Raum. Ein Modell besteht aus vielen, und aus dem Licht, das Scheiben spiegeln.</translation>
    </message>
    <message>
        <source>Above ellipsoid</source>
        <translation>Über Ellipsoid</translation>
    </message>
    <message>
        <source>Above sea level</source>
        <translation>Über Meer</translation>
    </message>
    <message>
        <source>Above take-off</source>
        <translation>Über Start</translation>
    </message>
    <message>
        <source>Address</source>
        <translation>Adresse</translation>
    </message>
    <message>
        <source>Aircraft at once</source>
        <translation>Fluggeräte zugleich</translation>
    </message>
    <message>
        <source>Airspace</source>
        <translation>Luftraum</translation>
    </message>
    <message>
        <source>Airspace around the building</source>
        <translation>Luftraum um das Gebäude</translation>
    </message>
    <message>
        <source>Autopilot</source>
        <translation>Autopilot</translation>
    </message>
    <message>
        <source>Batteries</source>
        <translation>Akkus</translation>
    </message>
    <message>
        <source>Battery reserve</source>
        <translation>Akkureserve</translation>
    </message>
    <message>
        <source>By how much unseen views of the model must get better, in decibels, for one battery more to be planned.</source>
        <translation>Um wie viel Dezibel nicht gesehene Ansichten des Modells besser werden müssen, damit ein Akku mehr geplant wird.</translation>
    </message>
    <message>
        <source>Clearance</source>
        <translation>Abstand</translation>
    </message>
    <message>
        <source>Coarsest GSD</source>
        <translation>Gröbste GSD</translation>
    </message>
    <message>
        <source>Corrections by which GNSS knows its place to centimetres instead of metres.</source>
        <translation>Korrekturen, mit denen GNSS seinen Ort auf Zentimeter statt auf Meter kennt.</translation>
    </message>
    <message>
        <source>Count whole panels only</source>
        <translation>Nur ganze Scheiben</translation>
    </message>
    <message>
        <source>Coverage</source>
        <translation>Abdeckung</translation>
    </message>
    <message>
        <source>Data set</source>
        <translation>Datensatz</translation>
    </message>
    <message>
        <source>EGM96 stands in for EGM2008: both differ by 0.5 m in the mean, at few places by several metres; home stands on the same terrain, so heights above take-off do not change</source>
        <translation>EGM96 steht für EGM2008: beide unterscheiden sich im Mittel um 0.5 m, an wenigen Orten um mehrere Meter; der Startplatz steht auf demselben Gelände, Höhen über dem Start ändern sich also nicht</translation>
    </message>
    <message>
        <source>Effects</source>
        <translation>Effekte</translation>
    </message>
    <message>
        <source>Equal panels in rows and columns, laid into a rectangle on a wall.</source>
        <translation>Gleiche Scheiben in Reihen und Spalten, in ein Rechteck auf einer Wand gelegt.</translation>
    </message>
    <message>
        <source>GNSS</source>
        <translation>GNSS</translation>
    </message>
    <message>
        <source>GNSS error</source>
        <translation>GNSS-Fehler</translation>
    </message>
    <message>
        <source>GSD</source>
        <translation>GSD</translation>
    </message>
    <message>
        <source>Ground risk by SORA 2.5: {0}</source>
        <translation>Bodenrisiko nach SORA 2.5: {0}</translation>
    </message>
    <message>
        <source>Ground sampling distance: how much of the facade one pixel shows. 2.7 mm shows a scratch, 20 mm a frame.</source>
        <translation>Ground Sampling Distance: wie viel der Fassade ein Pixel zeigt. 2.7 mm zeigen einen Kratzer, 20 mm einen Rahmen.</translation>
    </message>
    <message>
        <source>Height above the WGS 84 ellipsoid, as GNSS measures it. It is no height above the sea.</source>
        <translation>Höhe über dem Ellipsoid WGS 84, wie GNSS sie misst. Sie ist keine Höhe über dem Meer.</translation>
    </message>
    <message>
        <source>Heights are</source>
        <translation>Höhen sind</translation>
    </message>
    <message>
        <source>How many times faster than real time a simulated vehicle flies.</source>
        <translation>Wie viel schneller als in Wirklichkeit ein simuliertes Fluggerät fliegt.</translation>
    </message>
    <message>
        <source>How viewpoints are chosen. The optimised one takes the viewpoint that adds most, again and again, and proves how far from the best it can be; the others are there to compare with.</source>
        <translation>Wie Aufnahmepunkte gewählt werden. Das optimierte Verfahren nimmt immer wieder den Punkt, der am meisten bringt, und beweist, wie weit es höchstens vom besten entfernt ist; die anderen sind zum Vergleich da.</translation>
    </message>
    <message>
        <source>LPIPS unavailable: get its weights by &apos;score weights&apos;, or name them (--lpips)</source>
        <translation>LPIPS nicht verfügbar: Gewichte mit „score weights“ holen oder nennen (--lpips)</translation>
    </message>
    <message>
        <source>Layer</source>
        <translation>Ebene</translation>
    </message>
    <message>
        <source>Link</source>
        <translation>Verbindung</translation>
    </message>
    <message>
        <source>M1(A) medium and M1(B) count the same people; state one of them</source>
        <translation>M1(A) medium und M1(B) zählen dieselben Menschen; geben Sie eines davon an</translation>
    </message>
    <message>
        <source>M1(A) needs buildings that hold the aircraft off: glass roofs and facades may not</source>
        <translation>M1(A) braucht Gebäude, die das Fluggerät abhalten: Glasdächer und Glasfassaden tun das vielleicht nicht</translation>
    </message>
    <message>
        <source>Method</source>
        <translation>Verfahren</translation>
    </message>
    <message>
        <source>Not covered</source>
        <translation>Lücken</translation>
    </message>
    <message>
        <source>Nothing of the flight comes nearer than this to panels, building and obstacles.</source>
        <translation>Näher kommt der Flug Scheiben, Gebäude und Hindernissen nirgends.</translation>
    </message>
    <message>
        <source>Own poses</source>
        <translation>Eigene Posen</translation>
    </message>
    <message>
        <source>Photos with their poses, and the panels of the site: what a model learns from.</source>
        <translation>Fotos mit ihren Posen und die Scheiben des Standorts: wovon ein Modell lernt.</translation>
    </message>
    <message>
        <source>Place on earth</source>
        <translation>Lage auf der Erde</translation>
    </message>
    <message>
        <source>Pose</source>
        <translation>Pose</translation>
    </message>
    <message>
        <source>Precision</source>
        <translation>Genauigkeit</translation>
    </message>
    <message>
        <source>Quality</source>
        <translation>Güte</translation>
    </message>
    <message>
        <source>RTK</source>
        <translation>RTK</translation>
    </message>
    <message>
        <source>Rally point</source>
        <translation>Rally-Punkt</translation>
    </message>
    <message>
        <source>Refine poses</source>
        <translation>Posen verfeinern</translation>
    </message>
    <message>
        <source>Safety distance</source>
        <translation>Mindestabstand</translation>
    </message>
    <message>
        <source>Section step</source>
        <translation>Sektorweite</translation>
    </message>
    <message>
        <source>Single precision counts sections several times as fast, and errs on borders of sections alone.</source>
        <translation>Einfache Genauigkeit zählt Sektoren um ein Mehrfaches schneller und irrt nur an Grenzen von Sektoren.</translation>
    </message>
    <message>
        <source>Site origin</source>
        <translation>Nullpunkt</translation>
    </message>
    <message>
        <source>Sortie</source>
        <translation>Einsatz</translation>
    </message>
    <message>
        <source>Speed-up</source>
        <translation>Zeitraffer</translation>
    </message>
    <message>
        <source>Splat</source>
        <translation>Splat</translation>
    </message>
    <message>
        <source>Target coverage</source>
        <translation>Zielabdeckung</translation>
    </message>
    <message>
        <source>The box in which the aircraft must stay; only the climb above home may be below it.</source>
        <translation>Der Kasten, in dem das Fluggerät bleiben muss; nur der Aufstieg über dem Startplatz darf darunter liegen.</translation>
    </message>
    <message>
        <source>The computer that flies the aircraft: ArduPilot or PX4. They land, return and count battery differently.</source>
        <translation>Der Rechner, der das Fluggerät fliegt: ArduPilot oder PX4. Sie landen, kehren zurück und zählen den Akku verschieden.</translation>
    </message>
    <message>
        <source>The connection to the vehicle. A signed link takes no orders from others.</source>
        <translation>Die Verbindung zum Fluggerät. Eine signierte nimmt von anderen keine Befehle an.</translation>
    </message>
    <message>
        <source>The longest that the search may take. It ends sooner where nothing can be won any more.</source>
        <translation>So lange darf die Suche höchstens dauern. Sie endet früher, wenn nichts mehr zu gewinnen ist.</translation>
    </message>
    <message>
        <source>The place on earth from which the site counts metres east, north and up.</source>
        <translation>Der Ort auf der Erde, von dem aus der Standort Meter nach Osten, Norden und oben zählt.</translation>
    </message>
    <message>
        <source>The share of sections that photos show, of those that any flight could show at this site.</source>
        <translation>Der Anteil der Sektoren, die Fotos zeigen, an denen, die irgendein Flug an diesem Standort zeigen könnte.</translation>
    </message>
    <message>
        <source>The share of the charge with which the aircraft has to be back.</source>
        <translation>Der Anteil der Ladung, mit dem das Fluggerät zurück sein muss.</translation>
    </message>
    <message>
        <source>Time to plan</source>
        <translation>Planungszeit</translation>
    </message>
    <message>
        <source>Viewpoint</source>
        <translation>Aufnahmepunkt</translation>
    </message>
    <message>
        <source>Viewpoints</source>
        <translation>Punkte</translation>
    </message>
    <message>
        <source>Views</source>
        <translation>Aufnahmen</translation>
    </message>
    <message>
        <source>Views are chosen for</source>
        <translation>Ansichten gewählt für</translation>
    </message>
    <message>
        <source>Wanted GSD</source>
        <translation>Gewünschte GSD</translation>
    </message>
    <message>
        <source>Weight by solid angle</source>
        <translation>Raumwinkel gewichten</translation>
    </message>
    <message>
        <source>What is simulated because this scene calls for it; each says how large it is, why, and what it costs.</source>
        <translation>Was simuliert wird, weil diese Szene es verlangt; jeder sagt, wie groß er ist, warum, und was er kostet.</translation>
    </message>
    <message>
        <source>Where a photo was taken, and in which direction the camera looked.</source>
        <translation>Wo ein Foto aufgenommen wurde, und in welche Richtung die Kamera sah.</translation>
    </message>
    <message>
        <source>Worth</source>
        <translation>Wert</translation>
    </message>
    <message>
        <source>Worth another battery</source>
        <translation>Wert für weiteren Akku</translation>
    </message>
    <message>
        <source>a GeoTIFF</source>
        <translation>ein GeoTIFF</translation>
    </message>
    <message>
        <source>a draft: check every number before you use it</source>
        <translation>ein Entwurf: prüfen Sie jede Zahl, bevor Sie sie verwenden</translation>
    </message>
    <message>
        <source>a file of geo-zones: ED-269 or ED-318 JSON, GeoJSON, KML, AIXM 5.1 or OpenAir</source>
        <translation>eine Datei mit Geozonen: ED-269 oder ED-318 JSON, GeoJSON, KML, AIXM 5.1 oder OpenAir</translation>
    </message>
    <message>
        <source>a log book</source>
        <translation>ein Logbuch</translation>
    </message>
    <message>
        <source>a map tile</source>
        <translation>eine Kartenkachel</translation>
    </message>
    <message>
        <source>a part of its outline is a &apos;{0}&apos;, which is not read</source>
        <translation>ein Teil ihres Umrisses ist &apos;{0}&apos;, was nicht gelesen wird</translation>
    </message>
    <message>
        <source>a part of its outline stands elsewhere (&apos;{0}&apos;)</source>
        <translation>ein Teil ihres Umrisses steht anderswo (&apos;{0}&apos;)</translation>
    </message>
    <message>
        <source>a straight return home may leave the paths; set hover or land for lost links, or take the hull</source>
        <translation>eine gerade Rückkehr kann die Pfade verlassen; stellen Sie für Verbindungsverlust Schweben oder Landen ein, oder nehmen Sie die Hülle</translation>
    </message>
    <message>
        <source>adjacent area, from the contingency volume on</source>
        <translation>angrenzendes Gebiet, ab dem Notfallvolumen</translation>
    </message>
    <message>
        <source>air risk class (ARC) and SAIL</source>
        <translation>Luftrisikoklasse (ARC) und SAIL</translation>
    </message>
    <message>
        <source>all photos</source>
        <translation>alle Fotos</translation>
    </message>
    <message>
        <source>an assembly of people</source>
        <translation>eine Menschenansammlung</translation>
    </message>
    <message>
        <source>an overlay of shapes</source>
        <translation>eine Auflage mit Formen</translation>
    </message>
    <message>
        <source>another window writes it for too long; the flight is not in it</source>
        <translation>ein anderes Fenster schreibt es zu lange; der Flug steht nicht darin</translation>
    </message>
    <message>
        <source>as far as it falls</source>
        <translation>so weit es fällt</translation>
    </message>
    <message>
        <source>assumed: {0}</source>
        <translation>angenommen: {0}</translation>
    </message>
    <message>
        <source>authority: {0}</source>
        <translation>Behörde: {0}</translation>
    </message>
    <message>
        <source>battery {0}: flights: {1}, cycles: {2}</source>
        <translation>Akku {0}: Flüge: {1}, Zyklen: {2}</translation>
    </message>
    <message>
        <source>beyond the specific category with these people below; fly elsewhere, or keep people out</source>
        <translation>jenseits der speziellen Kategorie mit diesen Menschen darunter; fliegen Sie anderswo, oder halten Sie Menschen fern</translation>
    </message>
    <message>
        <source>braking tilt</source>
        <translation>Neigung beim Bremsen</translation>
    </message>
    <message>
        <source>climbed before the pilot acts</source>
        <translation>gestiegen, bevor der Pilot handelt</translation>
    </message>
    <message>
        <source>climbed by what momentum is left</source>
        <translation>gestiegen durch den verbliebenen Schwung</translation>
    </message>
    <message>
        <source>containment, and people in the adjacent area</source>
        <translation>Containment und Menschen im angrenzenden Gebiet</translation>
    </message>
    <message>
        <source>contingency volume</source>
        <translation>Notfallvolumen</translation>
    </message>
    <message>
        <source>contingency volume, to each side</source>
        <translation>Notfallvolumen, zu jeder Seite</translation>
    </message>
    <message>
        <source>corrections: a password is asked for, and not kept; leave it out of the address</source>
        <translation>Korrekturen: ein Passwort wird gefragt und nicht behalten; lassen Sie es aus der Adresse weg</translation>
    </message>
    <message>
        <source>corrections: expected USER@HOST:PORT/MOUNTPOINT, such as me@rtk.example.org:2101/VRS, got &apos;{0}&apos;</source>
        <translation>Korrekturen: erwartet wurde USER@HOST:PORT/MOUNTPOINT, etwa me@rtk.example.org:2101/VRS, es ist &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>cut out the part that is wanted</source>
        <translation>den gewünschten Teil ausschneiden</translation>
    </message>
    <message>
        <source>downwind, full speed</source>
        <translation>mit dem Wind, volle Geschwindigkeit</translation>
    </message>
    <message>
        <source>drag area when it falls, at most</source>
        <translation>Widerstandsfläche im Fall, höchstens</translation>
    </message>
    <message>
        <source>drag over the square of the speed, at most</source>
        <translation>Widerstand je Quadrat der Geschwindigkeit, höchstens</translation>
    </message>
    <message>
        <source>error of the height</source>
        <translation>Höhenfehler</translation>
    </message>
    <message>
        <source>even light {0}; all of it in the sun {1}; part of it {2}</source>
        <translation>gleichmäßiges Licht {0}; ganz in der Sonne {1}; zum Teil {2}</translation>
    </message>
    <message>
        <source>it covers nothing; take it closer or drop it</source>
        <translation>es deckt nichts ab; näher heran oder weglassen</translation>
    </message>
    <message>
        <source>it knows no mountpoint of this name; it has {0}</source>
        <translation>er kennt keinen Mountpoint dieses Namens; er hat {0}</translation>
    </message>
    <message>
        <source>sections seen only with pixels larger than {0} mm: {1} of {2} covered</source>
        <translation>Sektoren, nur mit Pixeln über {0} mm gesehen: {1} von {2} abgedeckten</translation>
    </message>
    <message>
        <source>site &apos;{0}&apos;</source>
        <translation>Standort &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>the panes mirror something that the site lacks: {0} x {1} m, {2} m high, {3} m from home at bearing {4}; the flight keeps clear of what is seen of it, but look before you fly, and enter it into the site</source>
        <translation>die Scheiben spiegeln etwas, das dem Standort fehlt: {0} x {1} m, {2} m hoch, {3} m vom Startplatz in Peilung {4}; der Flug hält Abstand von dem, was davon zu sehen ist, aber vor dem Flug hinsehen und es in den Standort eintragen</translation>
    </message>
    <message>
        <source>the plan&apos;s aircraft is not the one of its profile &apos;{0}&apos; now; plan the first flight again</source>
        <translation>das Fluggerät des Plans ist nicht mehr das seines Profils &apos;{0}&apos;; den ersten Flug neu planen</translation>
    </message>
    <message>
        <source>the tour does not fit {0}: expected each of its {1} points once, found {2}, missing {3}, unknown {4}</source>
        <translation>die Rundtour passt nicht zu {0}: erwartet wird jeder der {1} Punkte einmal, gefunden {2}, es fehlen {3}, unbekannt sind {4}</translation>
    </message>
    <message>
        <source>the two passphrases differ; nothing was changed</source>
        <translation>die beiden Passphrasen sind verschieden; nichts wurde geändert</translation>
    </message>
    <message>
        <source>the two vanishing points are nearly the same: this is not a plane seen from its front</source>
        <translation>die beiden Fluchtpunkte sind fast dieselben: das ist keine Ebene, die von vorn zu sehen ist</translation>
    </message>
    <message>
        <source>the vehicle does not say that it is a simulation: {0}; nothing was changed on it</source>
        <translation>das Fluggerät sagt nicht, dass es eine Simulation ist: {0}; nichts wurde daran geändert</translation>
    </message>
    <message>
        <source>the virtual screen Xvfb did not start; run it by hand to see why</source>
        <translation>der virtuelle Bildschirm Xvfb startete nicht; ihn von Hand starten, um zu sehen, warum</translation>
    </message>
    <message>
        <source>the worker {0} could not take the scene; see its own log</source>
        <translation>der Worker {0} konnte die Szene nicht übernehmen; siehe dessen Log</translation>
    </message>
    <message>
        <source>there are no views to photograph; name a plan or flight that has some</source>
        <translation>es gibt keine Ansichten zu fotografieren; einen Plan oder Flug nennen, der welche hat</translation>
    </message>
    <message>
        <source>there is a key</source>
        <translation>es gibt einen Schlüssel</translation>
    </message>
    <message>
        <source>there is neither a site file nor a bundled scene of that name; bundled are: {0}</source>
        <translation>es gibt weder eine Standortdatei noch eine mitgelieferte Szene dieses Namens; mitgeliefert sind: {0}</translation>
    </message>
    <message>
        <source>there is neither a window nor a glazed plate with geometry; {0}</source>
        <translation>es gibt weder ein Fenster noch eine verglaste Platte mit Geometrie; {0}</translation>
    </message>
    <message>
        <source>there is no bundled scene &apos;{0}&apos;; known are: {1}</source>
        <translation>es gibt keine mitgelieferte Szene &apos;{0}&apos;; bekannt sind: {1}</translation>
    </message>
    <message>
        <source>there is no effect &apos;{0}&apos; of single photos; expected one of {1}</source>
        <translation>es gibt keinen Effekt &apos;{0}&apos; einzelner Fotos; erwartet wird einer von {1}</translation>
    </message>
    <message>
        <source>there is no effect &apos;{0}&apos;; expected one of {1}</source>
        <translation>es gibt keinen Effekt &apos;{0}&apos;; erwartet wird einer von {1}</translation>
    </message>
    <message>
        <source>there is no key</source>
        <translation>es gibt keinen Schlüssel</translation>
    </message>
    <message>
        <source>there is no key any more; vehicles that know it keep it</source>
        <translation>es gibt keinen Schlüssel mehr; Fluggeräte, die ihn kennen, behalten ihn</translation>
    </message>
    <message>
        <source>there is no layer &apos;{0}&apos;; known are {1}</source>
        <translation>es gibt keine Ebene &apos;{0}&apos;; bekannt sind {1}</translation>
    </message>
    <message>
        <source>there is no precision &apos;{0}&apos;; known are: {1}</source>
        <translation>es gibt keine Genauigkeit &apos;{0}&apos;; bekannt sind: {1}</translation>
    </message>
    <message>
        <source>there is no routing method &apos;{0}&apos;; known are: {1}</source>
        <translation>es gibt kein Routenverfahren &apos;{0}&apos;; bekannt sind: {1}</translation>
    </message>
    <message>
        <source>there is no screen for the window (DISPLAY and WAYLAND_DISPLAY are not set); run it on a desktop, or use the commands (-h lists them)</source>
        <translation>es gibt keinen Bildschirm für das Fenster (DISPLAY und WAYLAND_DISPLAY sind nicht gesetzt); auf einem Desktop starten oder die Befehle benutzen (-h nennt sie)</translation>
    </message>
    <message>
        <source>there is no screen, and no Xvfb to stand in for one: install the package xvfb</source>
        <translation>es gibt keinen Bildschirm und kein Xvfb an dessen Stelle: das Paket xvfb installieren</translation>
    </message>
    <message>
        <source>there is no such file; expected ArduPilot&apos;s copter.parm</source>
        <translation>es gibt keine solche Datei; erwartet wird copter.parm von ArduPilot</translation>
    </message>
    <message>
        <source>there is no such project folder or site file</source>
        <translation>es gibt keinen solchen Projektordner und keine solche Standortdatei</translation>
    </message>
    <message>
        <source>they show {0} of {1} sections ({2} %)</source>
        <translation>sie zeigen {0} von {1} Sektoren ({2} %)</translation>
    </message>
    <message>
        <source>this camera has pixels of {0} mm at {1} m, but the minimum distance is {2} m; allow larger pixels or lower --min-distance</source>
        <translation>diese Kamera hat Pixel von {0} mm bei {1} m, aber der Mindestabstand ist {2} m; größere Pixel erlauben oder --min-distance senken</translation>
    </message>
    <message>
        <source>this could be a real aircraft, and &apos;simulate&apos; takes off by itself; add --take-off if it may</source>
        <translation>das könnte ein echtes Fluggerät sein, und &apos;simulate&apos; startet von selbst; --take-off dazunehmen, wenn es darf</translation>
    </message>
    <message>
        <source>this is a flight over &apos;{0}&apos;, and not over &apos;{1}&apos; at its origin; name the site that was flown over</source>
        <translation>das ist ein Flug über &apos;{0}&apos; und nicht über &apos;{1}&apos; an dessen Ursprung; den überflogenen Standort nennen</translation>
    </message>
    <message>
        <source>this is a plan of &apos;{0}&apos;, and not of &apos;{1}&apos; at its origin; name the site that it was made for, or another plan</source>
        <translation>das ist ein Plan von &apos;{0}&apos; und nicht von &apos;{1}&apos; an dessen Ursprung; den Standort nennen, für den er gemacht wurde, oder einen anderen Plan</translation>
    </message>
    <message>
        <source>this is a site of its own, which the mission&apos;s bare one would replace; name it with --site, or the plan otherwise</source>
        <translation>das ist ein eigener Standort, den der leere der Mission ersetzen würde; ihn mit --site nennen oder den Plan anders</translation>
    </message>
    <message>
        <source>time</source>
        <translation>Zeit</translation>
    </message>
    <message>
        <source>tolerance</source>
        <translation>Toleranz</translation>
    </message>
    <message>
        <source>truth: {0}, {1} s a photo{2}</source>
        <translation>Wahrheit: {0}, {1} s je Foto{2}</translation>
    </message>
    <message>
        <source>two of the files are called &apos;{0}&apos;; their names must differ to tell the results apart</source>
        <translation>zwei der Dateien heißen &apos;{0}&apos;; ihre Namen müssen verschieden sein, um die Ergebnisse zu unterscheiden</translation>
    </message>
    <message>
        <source>unrecognized arguments: %s</source>
        <translation>unbekannte Argumente: %s</translation>
    </message>
    <message>
        <source>unsaved: {0}</source>
        <translation>ungesichert: {0}</translation>
    </message>
    <message>
        <source>usage: </source>
        <translation>Aufruf: </translation>
    </message>
    <message>
        <source>vehicle {0} has the key and signs with it</source>
        <translation>Fluggerät {0} hat den Schlüssel und signiert damit</translation>
    </message>
    <message>
        <source>vehicle {0} was told to sign no more</source>
        <translation>Fluggerät {0} wurde angewiesen, nicht mehr zu signieren</translation>
    </message>
    <message>
        <source>views are planned or square to the facades; give one number, not both</source>
        <translation>Aufnahmen sind geplant oder rechtwinklig zu den Fassaden; eine Zahl angeben, nicht beide</translation>
    </message>
    <message>
        <source>wait for the vehicle</source>
        <translation>auf das Fluggerät warten</translation>
    </message>
    <message>
        <source>wait until every line of the list before take-off is well, or put it right</source>
        <translation>warten, bis jede Zeile der Liste vor dem Start in Ordnung ist, oder nachhelfen</translation>
    </message>
    <message>
        <source>warning: sortie {0}, {1} s: {2}</source>
        <translation>Warnung: Einsatz {0}, {1} s: {2}</translation>
    </message>
    <message>
        <source>warning: {0}, {1}: {2}</source>
        <translation>Warnung: {0}, {1}: {2}</translation>
    </message>
    <message>
        <source>watch the flight until it has landed</source>
        <translation>den Flug bis zur Landung verfolgen</translation>
    </message>
    <message>
        <source>what airspace &apos;{0}&apos; means for unmanned aircraft is national law: ask what holds here</source>
        <translation>was Luftraum &apos;{0}&apos; für unbemannte Luftfahrzeuge bedeutet, ist Landesrecht: fragen, was hier gilt</translation>
    </message>
    <message>
        <source>what is missing cannot be shown</source>
        <translation>was fehlt, ist nicht zu zeigen</translation>
    </message>
    <message>
        <source>what the vehicle sends makes no sense; take the card out</source>
        <translation>was das Fahrzeug sendet, ergibt keinen Sinn; nehmen Sie die Karte heraus</translation>
    </message>
    <message>
        <source>what {0} elements &apos;{1}&apos; show is not read; look at them yourself</source>
        <translation>was {0} Elemente &apos;{1}&apos; zeigen, wird nicht gelesen; selbst ansehen</translation>
    </message>
    <message>
        <source>when it applies cannot be read</source>
        <translation>wann sie gilt, ist nicht lesbar</translation>
    </message>
    <message>
        <source>when it is active, &apos;{0}&apos;, is decided elsewhere: ask for NOTAMs</source>
        <translation>wann sie aktiv ist, &apos;{0}&apos;, wird anderswo entschieden: nach NOTAMs fragen</translation>
    </message>
    <message>
        <source>where home stands the files have no heights: no flight can be planned until home is moved</source>
        <translation>am Startplatz haben die Dateien keine Höhen: bis er verschoben ist, lässt sich kein Flug planen</translation>
    </message>
    <message>
        <source>where the ground is not known, the surface counts as ground</source>
        <translation>wo der Boden nicht bekannt ist, zählt die Oberfläche als Boden</translation>
    </message>
    <message>
        <source>whole</source>
        <translation>ganz</translation>
    </message>
    <message>
        <source>why</source>
        <translation>warum</translation>
    </message>
    <message>
        <source>with the records the file would have {0} instances, {1} were expected; it is written in a way that is not understood; save it anew in a BIM program</source>
        <translation>mit den Einträgen hätte die Datei {0} Instanzen, erwartet wurden {1}; sie ist auf eine Weise geschrieben, die nicht verstanden wird; in einem BIM-Programm neu speichern</translation>
    </message>
    <message>
        <source>within {0} % of the {1}</source>
        <translation>innerhalb von {0} % vom Wert: {1}</translation>
    </message>
    <message>
        <source>worst</source>
        <translation>schlechteste</translation>
    </message>
    <message>
        <source>zone &apos;{0}&apos;: expected the reference of the authorisation, got an empty text</source>
        <translation>Zone &apos;{0}&apos;: erwartet wird das Aktenzeichen der Genehmigung, angegeben ist ein leerer Text</translation>
    </message>
    <message>
        <source>{0}  {1}: {2} of {3} added ({4})</source>
        <translation>{0}  {1}: {2} von {3} dazugekommen ({4})</translation>
    </message>
    <message>
        <source>{0}  {1}: {2} of {3} changed ({4})</source>
        <translation>{0}  {1}: {2} von {3} geändert ({4})</translation>
    </message>
    <message>
        <source>{0}  {1}: {2} of {3} removed ({4})</source>
        <translation>{0}  {1}: {2} von {3} entfernt ({4})</translation>
    </message>
    <message>
        <source>{0} % of what can be covered in sections of {1}°</source>
        <translation>{0} % dessen, was in Sektoren zu {1}° abzudecken ist</translation>
    </message>
    <message>
        <source>{0} Gaussian</source>
        <translation>{0} Gauß-Splat</translation>
    </message>
    <message>
        <source>{0} Gaussians</source>
        <translation>{0} Gauß-Splats</translation>
    </message>
    <message>
        <source>{0} MB</source>
        <translation>{0} MB</translation>
    </message>
    <message>
        <source>{0} MB  {1}</source>
        <translation>{0} MB  {1}</translation>
    </message>
    <message>
        <source>{0} added, {1} in the project</source>
        <translation>{0} dazugekommen, {1} im Projekt</translation>
    </message>
    <message>
        <source>{0} and {1} have one name; keep one of them</source>
        <translation>{0} und {1} haben einen Namen; eines davon behalten</translation>
    </message>
    <message>
        <source>{0} at most</source>
        <translation>höchstens {0}</translation>
    </message>
    <message>
        <source>{0} changed</source>
        <translation>{0} geändert</translation>
    </message>
    <message>
        <source>{0} column</source>
        <translation>{0} Spalte</translation>
    </message>
    <message>
        <source>{0} columns</source>
        <translation>{0} Spalten</translation>
    </message>
    <message>
        <source>{0} cover {1} of {2} sections; no flight can cover more than {3}</source>
        <translation>{0} decken {1} von {2} Sektoren ab; kein Flug kann mehr als {3} abdecken</translation>
    </message>
    <message>
        <source>{0} did not come: {1}</source>
        <translation>{0} kam nicht: {1}</translation>
    </message>
    <message>
        <source>{0} facade</source>
        <translation>{0} Fassade</translation>
    </message>
    <message>
        <source>{0} facades</source>
        <translation>{0} Fassaden</translation>
    </message>
    <message>
        <source>{0} geo-zones that apply at some times only count as if they always did (the first is &apos;{1}&apos;): no time is planned (--at)</source>
        <translation>{0} Geozonen, die nur zu manchen Zeiten gelten, zählen, als gälten sie immer (die erste ist &apos;{1}&apos;): es ist keine Zeit geplant (--at)</translation>
    </message>
    <message>
        <source>{0} goes with --panel-grid, which is missing</source>
        <translation>{0} gehört zu --panel-grid, das fehlt</translation>
    </message>
    <message>
        <source>{0} has roofs and trees in it, smoothed: they count as ground, not as obstacles</source>
        <translation>{0} enthält Dächer und Bäume, geglättet: sie zählen als Boden, nicht als Hindernisse</translation>
    </message>
    <message>
        <source>{0} has {1} x {2} pixels; expected at most {3}</source>
        <translation>{0} hat {1} x {2} Pixel; erwartet werden höchstens {3}</translation>
    </message>
    <message>
        <source>{0} hit</source>
        <translation>{0} Treffer</translation>
    </message>
    <message>
        <source>{0} hits</source>
        <translation>{0} Treffer</translation>
    </message>
    <message>
        <source>{0} in no photo at all</source>
        <translation>{0} auf keinem Foto</translation>
    </message>
    <message>
        <source>{0} in {1} and {2}, confidence {3} or more</source>
        <translation>{0} in {1} und {2}, Sicherheit {3} oder mehr</translation>
    </message>
    <message>
        <source>{0} in {1}, {2} min in the air</source>
        <translation>{0} in {1}, {2} min in der Luft</translation>
    </message>
    <message>
        <source>{0} in {1}, {2} min in the air, close {3} of {4} missing sections</source>
        <translation>{0} in {1}, {2} min in der Luft, schließen {3} von {4} fehlenden Sektoren</translation>
    </message>
    <message>
        <source>{0} is damaged</source>
        <translation>{0} ist beschädigt</translation>
    </message>
    <message>
        <source>{0} is good to {1} m at nine of ten places: so much more is kept above the ground; another value can be given with --accuracy</source>
        <translation>{0} stimmt an neun von zehn Orten auf {1} m: so viel mehr Höhe über Grund wird gehalten; ein anderer Wert lässt sich mit --accuracy angeben</translation>
    </message>
    <message>
        <source>{0} is missing</source>
        <translation>{0} fehlt</translation>
    </message>
    <message>
        <source>{0} is missing; expected {1}</source>
        <translation>{0} fehlt; erwartet wird {1}</translation>
    </message>
    <message>
        <source>{0} is not known on {1} % of the area: no flight is planned there</source>
        <translation>{0} ist auf {1} % der Fläche nicht bekannt: dort wird kein Flug geplant</translation>
    </message>
    <message>
        <source>{0} is {1}, which has no place in MISSION_ITEM_INT; expected {2}</source>
        <translation>{0} ist {1}, wofür MISSION_ITEM_INT keinen Platz hat; erwartet wird {2}</translation>
    </message>
    <message>
        <source>{0} looked at in {1} s; glass of held-out photos: {2} dB</source>
        <translation>{0} in {1} s betrachtet; Glas zurückgehaltener Fotos: {2} dB</translation>
    </message>
    <message>
        <source>{0} m above the terrain</source>
        <translation>{0} m über dem Gelände</translation>
    </message>
    <message>
        <source>{0} m kept at least</source>
        <translation>{0} m mindestens eingehalten</translation>
    </message>
    <message>
        <source>{0} more like this (--json lists all)</source>
        <translation>{0} weitere dieser Art (--json nennt alle)</translation>
    </message>
    <message>
        <source>{0} object</source>
        <translation>{0} Objekt</translation>
    </message>
    <message>
        <source>{0} objects</source>
        <translation>{0} Objekte</translation>
    </message>
    <message>
        <source>{0} objects, {1} new, {2} changed, {3} no longer in the model</source>
        <translation>{0} Objekte, {1} neu, {2} geändert, {3} nicht mehr im Modell</translation>
    </message>
    <message>
        <source>{0} of &apos;{1}&apos;{2}</source>
        <translation>{0} von &apos;{1}&apos;{2}</translation>
    </message>
    <message>
        <source>{0} of a battery{1}</source>
        <translation>{0} eines Akkus{1}</translation>
    </message>
    <message>
        <source>{0} of facade {1}</source>
        <translation>{0} der Fassade {1}</translation>
    </message>
    <message>
        <source>{0} of these with pixels up to {1} mm on the panel, the coarsest with {2} mm</source>
        <translation>{0} davon mit Pixeln bis {1} mm auf der Scheibe, die gröbsten mit {2} mm</translation>
    </message>
    <message>
        <source>{0} of {1}</source>
        <translation>{0} aus {1}</translation>
    </message>
    <message>
        <source>{0} of {1} corners of an outline are no places on earth</source>
        <translation>{0} von {1} Ecken eines Umrisses sind keine Orte auf der Erde</translation>
    </message>
    <message>
        <source>{0} of {1} photos show a facade half in the sun with take-off at {2}</source>
        <translation>mit Start um {2} zeigen {0} von {1} Fotos eine Fassade, die zum Teil in der Sonne liegt</translation>
    </message>
    <message>
        <source>{0} of {1} views</source>
        <translation>{0} von {1} Aufnahmen</translation>
    </message>
    <message>
        <source>{0} on {1}</source>
        <translation>{0} auf {1}</translation>
    </message>
    <message>
        <source>{0} on {1}: {2}{3}</source>
        <translation>{0} auf {1}: {2}{3}</translation>
    </message>
    <message>
        <source>{0} or more</source>
        <translation>{0} oder mehr</translation>
    </message>
    <message>
        <source>{0} or {1}</source>
        <translation>{0} oder {1}</translation>
    </message>
    <message>
        <source>{0} panel</source>
        <translation>{0} Scheibe</translation>
    </message>
    <message>
        <source>{0} panels</source>
        <translation>{0} Scheiben</translation>
    </message>
    <message>
        <source>{0} panels in {1} photos</source>
        <translation>{0} Scheiben in {1} Fotos</translation>
    </message>
    <message>
        <source>{0} photo</source>
        <translation>{0} Foto</translation>
    </message>
    <message>
        <source>{0} photos with their truth take about {1}, and {2} are free there; make room, name a folder on another disk, or ask for smaller pictures (--width)</source>
        <translation>{0} Fotos mit ihrer Wahrheit brauchen etwa {1}, und dort sind {2} frei; Platz schaffen, einen Ordner auf einem anderen Datenträger nennen oder kleinere Bilder verlangen (--width)</translation>
    </message>
    <message>
        <source>{0} photos, {1} panels</source>
        <translation>{0} Fotos, {1} Scheiben</translation>
    </message>
    <message>
        <source>{0} picture</source>
        <translation>{0} Bild</translation>
    </message>
    <message>
        <source>{0} pictures</source>
        <translation>{0} Bilder</translation>
    </message>
    <message>
        <source>{0} plan</source>
        <translation>{0} Plan</translation>
    </message>
    <message>
        <source>{0} plans</source>
        <translation>{0} Pläne</translation>
    </message>
    <message>
        <source>{0} positions are none and were left out</source>
        <translation>{0} Positionen sind keine und wurden weggelassen</translation>
    </message>
    <message>
        <source>{0} prepared</source>
        <translation>{0} vorbereitet</translation>
    </message>
    <message>
        <source>{0} record</source>
        <translation>{0} Aufzeichnung</translation>
    </message>
    <message>
        <source>{0} records</source>
        <translation>{0} Aufzeichnungen</translation>
    </message>
    <message>
        <source>{0} row</source>
        <translation>{0} Reihe</translation>
    </message>
    <message>
        <source>{0} rows</source>
        <translation>{0} Reihen</translation>
    </message>
    <message>
        <source>{0} s flown</source>
        <translation>{0} s geflogen</translation>
    </message>
    <message>
        <source>{0} s predicted</source>
        <translation>{0} s vorhergesagt</translation>
    </message>
    <message>
        <source>{0} sortie</source>
        <translation>{0} Einsatz</translation>
    </message>
    <message>
        <source>{0} sorties</source>
        <translation>{0} Einsätze</translation>
    </message>
    <message>
        <source>{0} splat</source>
        <translation>{0} Splat</translation>
    </message>
    <message>
        <source>{0} splats</source>
        <translation>{0} Splats</translation>
    </message>
    <message>
        <source>{0} step</source>
        <translation>{0} Schritt</translation>
    </message>
    <message>
        <source>{0} steps</source>
        <translation>{0} Schritte</translation>
    </message>
    <message>
        <source>{0} through {1} points, proven to be {2}
{3}, {4} s; the nearest neighbour gives {5} ({6})</source>
        <translation>{0} durch {1} Punkte, bewiesen: {2}
{3}, {4} s; der nächste Nachbar ergibt {5} ({6})</translation>
    </message>
    <message>
        <source>{0} to below {1}</source>
        <translation>{0} bis unter {1}</translation>
    </message>
    <message>
        <source>{0} to {1}</source>
        <translation>{0} bis {1}</translation>
    </message>
    <message>
        <source>{0} view</source>
        <translation>{0} Aufnahme</translation>
    </message>
    <message>
        <source>{0} warning</source>
        <translation>{0} Warnung</translation>
    </message>
    <message>
        <source>{0} warnings</source>
        <translation>{0} Warnungen</translation>
    </message>
    <message>
        <source>{0} with &apos;{1}&apos;</source>
        <translation>{0} mit &apos;{1}&apos;</translation>
    </message>
    <message>
        <source>{0} with a pose, {1} usable{2}</source>
        <translation>{0} mit Pose, {1} brauchbar{2}</translation>
    </message>
    <message>
        <source>{0} with the GlobalId of the building model</source>
        <translation>{0} mit der GlobalId des Gebäudemodells</translation>
    </message>
    <message>
        <source>{0} without Gaussians of their own: no photo showed them, or the method knows no panels</source>
        <translation>{0} ohne eigene Gauß-Splats: kein Foto zeigte sie, oder das Verfahren kennt keine Scheiben</translation>
    </message>
    <message>
        <source>{0} x {1} pixels, but its photo has {2} x {3}</source>
        <translation>{0} x {1} Pixel, aber sein Foto hat {2} x {3}</translation>
    </message>
    <message>
        <source>{0} {1}</source>
        <translation>{0} {1}</translation>
    </message>
    <message>
        <source>{0} {1} {2}° seed {3}</source>
        <translation>{0} {1} {2}° Seed {3}</translation>
    </message>
    <message>
        <source>{0} {1}, {2} min, {3} m/s, wind up to {4} m/s; {5}, {6} x {7}, {8} mm, gimbal {9} to {10} deg</source>
        <translation>{0} {1}, {2} min, {3} m/s, Wind bis {4} m/s; {5}, {6} x {7}, {8} mm, Gimbal {9} bis {10} Grad</translation>
    </message>
    <message>
        <source>{0}, the coarsest with {1} mm</source>
        <translation>{0}, das gröbste mit {1} mm</translation>
    </message>
    <message>
        <source>{0}: continue mission ({1})</source>
        <translation>{0}: Mission fortsetzen ({1})</translation>
    </message>
    <message>
        <source>{0}: it does not apply at the planned time</source>
        <translation>{0}: sie gilt zur geplanten Zeit nicht</translation>
    </message>
    <message>
        <source>{0}: it restricts nothing</source>
        <translation>{0}: sie beschränkt nichts</translation>
    </message>
    <message>
        <source>{0}: the path enters it</source>
        <translation>{0}: der Weg führt hinein</translation>
    </message>
    <message>
        <source>{0}: the path runs inside, by the authorisation &apos;{1}&apos;</source>
        <translation>{0}: der Weg führt hindurch, mit der Genehmigung &apos;{1}&apos;</translation>
    </message>
    <message>
        <source>{0}: the path stays out of it, {1} m away</source>
        <translation>{0}: der Weg bleibt draußen, {1} m entfernt</translation>
    </message>
    <message>
        <source>{0}: where it lies is not sure, so it is not clear: {1}; ask, and state the answer (--permit)</source>
        <translation>{0}: wo sie liegt, ist nicht sicher, darum gilt sie nicht als frei: {1}; fragen und die Antwort angeben (--permit)</translation>
    </message>
    <message>
        <source>{0}: {1}</source>
        <translation>{0}: {1}</translation>
    </message>
    <message>
        <source>{0}; allow more views, or a larger pixel</source>
        <translation>{0}; mehr Aufnahmen oder ein größeres Pixel zulassen</translation>
    </message>
    <message>
        <source>{0} views were left out, since the time did not last for ways to them; allow it more time</source>
        <translation>ausgelassene Aufnahmen: {0}, da die Zeit nicht für Wege zu ihnen gereicht hat; mehr Zeit geben</translation>
    </message>
    <message>
        <source>no panel is seen from any viewpoint</source>
        <translation>von keinem Aufnahmepunkt ist eine Scheibe zu sehen</translation>
    </message>
    <message>
        <source>{0} of {1} sections are covered, as the plan states</source>
        <translation>{0} von {1} Sektoren sind abgedeckt, wie der Plan angibt</translation>
    </message>
    <message>
        <source>{0} of {1} sections are covered, but the plan states {2} of {3}</source>
        <translation>{0} von {1} Sektoren sind abgedeckt, der Plan gibt aber {2} von {3} an</translation>
    </message>
    <message>
        <source>viewpoints that repeat another</source>
        <translation>Aufnahmepunkte, die einen anderen wiederholen</translation>
    </message>
    <message>
        <source>they cost time and show nothing new</source>
        <translation>sie kosten Zeit und zeigen nichts Neues</translation>
    </message>
    <message>
        <source>move them inside or widen the airspace</source>
        <translation>hineinschieben oder den Luftraum erweitern</translation>
    </message>
    <message>
        <source>viewpoints outside the airspace by</source>
        <translation>Aufnahmepunkte außerhalb des Luftraums um</translation>
    </message>
    <message>
        <source>only the column above home may lie below the airspace</source>
        <translation>nur die Säule über dem Startplatz darf unter dem Luftraum liegen</translation>
    </message>
    <message>
        <source>paths outside the airspace by</source>
        <translation>Flugwege außerhalb des Luftraums um</translation>
    </message>
    <message>
        <source>smallest distance at a viewpoint (negative: inside a solid)</source>
        <translation>kleinster Abstand an einem Aufnahmepunkt (negativ: im Inneren)</translation>
    </message>
    <message>
        <source>move it away</source>
        <translation>weiter weg schieben</translation>
    </message>
    <message>
        <source>the path runs inside a solid</source>
        <translation>der Flugweg führt durch etwas Festes</translation>
    </message>
    <message>
        <source>plan the route again</source>
        <translation>die Route neu planen</translation>
    </message>
    <message>
        <source>{0}, leg {1}</source>
        <translation>{0}, Strecke {1}</translation>
    </message>
    <message>
        <source>smallest distance along the path</source>
        <translation>kleinster Abstand entlang des Flugwegs</translation>
    </message>
    <message>
        <source>the site has no no-fly volumes</source>
        <translation>der Standort hat keine Flugverbotszonen</translation>
    </message>
    <message>
        <source>smallest distance to a no-fly volume (negative: inside)</source>
        <translation>kleinster Abstand zu einer Flugverbotszone (negativ: darin)</translation>
    </message>
    <message>
        <source>the path enters a no-fly volume</source>
        <translation>der Flugweg führt in eine Flugverbotszone</translation>
    </message>
    <message>
        <source>most rules ask for a permit above it</source>
        <translation>darüber verlangen die meisten Vorschriften eine Genehmigung</translation>
    </message>
    <message>
        <source>greatest height above ground</source>
        <translation>größte Höhe über Grund</translation>
    </message>
    <message>
        <source>{0} legs are shorter than DJI firmware likes</source>
        <translation>{0} Strecken sind kürzer, als DJI-Geräte mögen</translation>
    </message>
    <message>
        <source>shortest leg</source>
        <translation>kürzeste Strecke</translation>
    </message>
    <message>
        <source>autopilots refuse it</source>
        <translation>Autopiloten lehnen sie ab</translation>
    </message>
    <message>
        <source>longest leg</source>
        <translation>längste Strecke</translation>
    </message>
    <message>
        <source>% of the lines of sight</source>
        <translation>% der Sichtlinien</translation>
    </message>
    <message>
        <source>nothing stands in front of any panel</source>
        <translation>vor keiner Scheibe steht etwas</translation>
    </message>
    <message>
        <source>there is no place to look from</source>
        <translation>es gibt keinen Ort, von dem aus man schauen könnte</translation>
    </message>
    <message>
        <source>no allowed place lies in front of a panel</source>
        <translation>kein erlaubter Ort liegt vor einer Scheibe</translation>
    </message>
    <message>
        <source>something stands in front of {0} % of the panels</source>
        <translation>vor {0} % der Scheiben steht etwas</translation>
    </message>
    <message>
        <source>no viewpoint that sees a panel can be reached and left again within {0} s of one battery</source>
        <translation>kein Aufnahmepunkt, der eine Scheibe sieht, ist innerhalb von {0} s eines Akkus zu erreichen und wieder zu verlassen</translation>
    </message>
    <message>
        <source>the {0} locked viewpoints alone take {1} batteries, but {2} are allowed; unlock some, or allow more batteries</source>
        <translation>die {0} fixierten Aufnahmepunkte allein brauchen {1} Akkus, erlaubt sind {2}; einige freigeben oder mehr Akkus erlauben</translation>
    </message>
    <message>
        <source>the {0} locked viewpoints alone need more batteries than are allowed; unlock some, or allow more</source>
        <translation>die {0} fixierten Aufnahmepunkte allein brauchen mehr Akkus als erlaubt; einige freigeben oder mehr erlauben</translation>
    </message>
    <message>
        <source>it looks {0} deg up, and the gimbal turns from {1} to {2} deg</source>
        <translation>er blickt {0}° nach oben, und der Gimbal dreht von {1} bis {2}°</translation>
    </message>
    <message>
        <source>viewpoint &apos;{0}&apos; is locked, but cannot be flown: {1}; unlock it, or move it first</source>
        <translation>Aufnahmepunkt &apos;{0}&apos; ist fixiert, kann aber nicht geflogen werden: {1}; ihn freigeben oder zuerst verschieben</translation>
    </message>
    <message>
        <source>it lies {0} m outside the airspace or on its border</source>
        <translation>er liegt {0} m außerhalb des Luftraums oder auf dessen Rand</translation>
    </message>
    <message>
        <source>expected 0 m or more, got {0}</source>
        <translation>erwartet werden 0 m oder mehr, nicht {0}</translation>
    </message>
    <message>
        <source>expected sharp from 0 to {0}, got {1}</source>
        <translation>erwartet wurde scharf von 0 bis {0}, gefunden wurde {1}</translation>
    </message>
    <message>
        <source>pixel of sharp views (mm)</source>
        <translation>Pixel scharfer Aufnahmen (mm)</translation>
    </message>
    <message>
        <source>it lies {0} m below the lowest flight allowed or on its border</source>
        <translation>er liegt {0} m unter der niedrigsten erlaubten Flughöhe oder auf deren Rand</translation>
    </message>
    <message>
        <source>lowest height above the ground beside the take-off column</source>
        <translation>niedrigste Höhe über Boden abseits der Startsäule</translation>
    </message>
    <message>
        <source>plan it again, or allow lower flights</source>
        <translation>neu planen oder niedrigere Flüge erlauben</translation>
    </message>
    <message>
        <source>flights down to {0} m above the ground are allowed, below the usual {1} m: look for people, cars and cables on the whole way</source>
        <translation>Flüge bis hinab auf {0} m über Boden sind erlaubt, tiefer als die üblichen {1} m: auf dem ganzen Weg auf Menschen, Autos und Kabel achten</translation>
    </message>
    <message>
        <source>{0} sections (on {1} panels, the first is &apos;{2}&apos;) {3}</source>
        <translation>{0} Sektoren (an {1} Scheiben, die erste ist &apos;{2}&apos;) {3}</translation>
    </message>
    <message>
        <source>have no place from which they are known to be seen, and no proof that there is none, so that they count as possible; {0}</source>
        <translation>haben keinen bekannten Ort, von dem sie zu sehen sind, und keinen Beweis, dass es keinen gibt, so dass sie als möglich zählen; {0}</translation>
    </message>
    <message>
        <source>are only seen from places to which no way from home was found that keeps {0} m from everything; move home, or lower the minimum distance</source>
        <translation>sind nur von Orten zu sehen, zu denen kein Weg vom Startplatz gefunden wurde, der von allem {0} m Abstand hält; den Startplatz verlegen oder den Mindestabstand senken</translation>
    </message>
    <message>
        <source>are only seen from places less than {0} m from other viewpoints, which {1} refuses; more time does not help</source>
        <translation>sind nur von Orten zu sehen, die weniger als {0} m von anderen Aufnahmepunkten entfernt sind, was {1} verweigert; mehr Zeit hilft nicht</translation>
    </message>
    <message>
        <source>can be covered; allow it more time</source>
        <translation>lassen sich abdecken; mehr Zeit geben</translation>
    </message>
    <message>
        <source>compiled for this computer in {0} s, once; the time budget began behind it</source>
        <translation>in {0} s für diesen Rechner übersetzt, einmalig; die Zeitvorgabe begann danach</translation>
    </message>
    <message>
        <source>inside a solid</source>
        <translation>tief in etwas Festem</translation>
    </message>
    <message>
        <source>from the building or an obstacle</source>
        <translation>vom Gebäude oder von einem Hindernis</translation>
    </message>
    <message>
        <source>it is {0} m {1}, and {2} m are required</source>
        <translation>er liegt {0} m {1}, und {2} m sind verlangt</translation>
    </message>
    <message>
        <source>it is in a no-fly volume or less than {0} m from one</source>
        <translation>er liegt in einer Flugverbotszone oder näher als {0} m an einer</translation>
    </message>
    <message>
        <source>no way from home to it was found</source>
        <translation>vom Startplatz wurde kein Weg dorthin gefunden</translation>
    </message>
    <message>
        <source>no allowed viewpoint sees any panel: the airspace may be empty or too close to the building, the panels&apos; corners clockwise (normals pointing inwards), or the minimum distance too large</source>
        <translation>kein erlaubter Aufnahmepunkt sieht eine Scheibe: Der Luftraum kann leer oder zu nah am Gebäude sein, die Ecken der Scheiben können im Uhrzeigersinn stehen (Normalen nach innen), oder der Mindestabstand ist zu groß</translation>
    </message>
    <message>
        <source>method &apos;{0}&apos; cannot plan for a number of batteries; &apos;greedy&apos; can</source>
        <translation>das Verfahren &apos;{0}&apos; kann nicht für eine Anzahl von Akkus planen; „Greedy mit Beweis“ kann es</translation>
    </message>
    <message>
        <source>method &apos;{0}&apos; cannot keep locked viewpoints; &apos;greedy&apos; can, or unlock them</source>
        <translation>das Verfahren &apos;{0}&apos; kann fixierte Aufnahmepunkte nicht behalten; „Greedy mit Beweis“ kann es, oder sie freigeben</translation>
    </message>
    <message>
        <source>method &apos;pso&apos; needs a number of views (--views N); it cannot look for the fewest</source>
        <translation>das Verfahren &apos;pso&apos; braucht eine Anzahl von Aufnahmen; nach den wenigsten suchen kann es nicht</translation>
    </message>
    <message>
        <source>airspace: no place in it keeps {0} m from the building and all obstacles; widen the airspace or lower the minimum distance</source>
        <translation>Luftraum: An keinem Ort darin sind es {0} m zum Gebäude und allen Hindernissen; den Luftraum erweitern oder den Mindestabstand verkleinern</translation>
    </message>
    <message>
        <source>panel &apos;{0}&apos; looks into a solid: its corners may be clockwise, or the mesh covers it</source>
        <translation>Scheibe &apos;{0}&apos; blickt in etwas Festes: Ihre Ecken stehen vielleicht im Uhrzeigersinn, oder das Netz verdeckt sie</translation>
    </message>
    <message>
        <source>no allowed viewpoint sees panel &apos;{0}&apos;</source>
        <translation>kein erlaubter Aufnahmepunkt sieht die Scheibe &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>home stands {0} m from a no-fly volume; no more than that is kept from it</source>
        <translation>der Startplatz liegt {0} m von einer Flugverbotszone; mehr wird von ihr nicht eingehalten</translation>
    </message>
    <message>
        <source>viewpoint &apos;{0}&apos; is locked and stays as it is; unlock it before it is {1}</source>
        <translation>Aufnahmepunkt &apos;{0}&apos; ist fixiert und bleibt, wie er ist; ihn freigeben, bevor er {1} wird</translation>
    </message>
    <message>
        <source>the views cannot be shared out so that every sortie fits {0}&apos;s battery and waypoint limit; lower the reserve or the number of views</source>
        <translation>die Aufnahmen lassen sich nicht so aufteilen, dass jeder Einsatz zu Akku und Wegpunktgrenze von {0} passt; die Reserve oder die Zahl der Aufnahmen verkleinern</translation>
    </message>
    <message>
        <source>no way from ({0:m}) to ({1:m}) m was found that keeps {2} m from everything; leave the place out, widen the airspace or lower the minimum distance</source>
        <translation>von ({0:m}) nach ({1:m}) m wurde kein Weg gefunden, der zu allem {2} m Abstand hält; den Ort weglassen, den Luftraum erweitern oder den Mindestabstand verkleinern</translation>
    </message>
    <message>
        <source>home {0:m} is not below or inside the airspace box {1:m} to {2:m}; move home or widen the airspace</source>
        <translation>der Startplatz {0:m} liegt weder unter noch in dem Luftraum {1:m} bis {2:m}; ihn verschieben oder den Luftraum erweitern</translation>
    </message>
    <message>
        <source>home {0:m} lies inside a building or obstacle; move it outside</source>
        <translation>der Startplatz {0:m} liegt in einem Gebäude oder Hindernis; ihn hinausschieben</translation>
    </message>
    <message>
        <source>home {0:m} lies inside a no-fly volume; move it outside</source>
        <translation>der Startplatz {0:m} liegt in einer Flugverbotszone; ihn hinausschieben</translation>
    </message>
    <message>
        <source>the take-off column above home {0:m} comes within {1} m of the building or an obstacle, {2} m are required; move home away</source>
        <translation>die Startsäule über dem Startplatz {0:m} kommt dem Gebäude oder einem Hindernis auf {1} m nahe, {2} m sind verlangt; den Startplatz wegrücken</translation>
    </message>
    <message>
        <source>the take-off column above home {0:m} crosses a no-fly volume</source>
        <translation>die Startsäule über dem Startplatz {0:m} kreuzt eine Flugverbotszone</translation>
    </message>
    <message>
        <source>more time does not help</source>
        <translation>mehr Zeit hilft nicht</translation>
    </message>
    <message>
        <source>covers {0} % of what is possible at most, {1} % were asked for</source>
        <translation>deckt {0} % dessen ab, was höchstens möglich ist; gewünscht waren {1} %</translation>
    </message>
    <message>
        <source>takes {0} of {1} batteries: more views would show nothing new or could not be flown</source>
        <translation>braucht {0} von {1} Akkus: Mehr Aufnahmen würden nichts Neues zeigen oder wären nicht zu fliegen</translation>
    </message>
    <message>
        <source>viewpoint {0}</source>
        <translation>Aufnahmepunkt {0}</translation>
    </message>
    <message>
        <source>airspace: its ceiling lies {0} m above the ground, and flights keep {1} m from it; raise the ceiling, or allow lower flights</source>
        <translation>Luftraum: seine Decke liegt {0} m über dem Boden, und Flüge halten von ihm {1} m Abstand; die Decke anheben oder niedrigere Flüge erlauben</translation>
    </message>
    <message>
        <source>expected at least the {0} locked ones, got {1}</source>
        <translation>erwartet wurden mindestens die {0} fixierten, gefunden: {1}</translation>
    </message>
    <message>
        <source>expected unique ids</source>
        <translation>erwartet wurden eindeutige Kennungen</translation>
    </message>
    <message>
        <source> ({0} more are too far as well)</source>
        <translation> ({0} weitere sind ebenfalls zu weit weg)</translation>
    </message>
    <message>
        <source>{0} cannot be reached from home and left again{1}; leave it out</source>
        <translation>{0} ist vom Startplatz nicht zu erreichen und wieder zu verlassen{1}; weglassen</translation>
    </message>
    <message>
        <source>{0} takes {1} s on a sortie of its own, but a battery allows {2} s{3}; move home closer, raise the speed, lower the reserve or leave it out</source>
        <translation>{0} braucht auf einem eigenen Einsatz {1} s, ein Akku erlaubt aber {2} s{3}; den Startplatz näher legen, schneller fliegen, die Reserve verkleinern oder weglassen</translation>
    </message>
    <message>
        <source>stop {0} has a load of {1}, above {2}</source>
        <translation>Halt {0} hat eine Last von {1}, mehr als {2}</translation>
    </message>
    <message>
        <source>every order needs a leg that does not exist</source>
        <translation>jede Reihenfolge braucht eine Strecke, die es nicht gibt</translation>
    </message>
    <message>
        <source>none was found</source>
        <translation>es wurde keine gefunden</translation>
    </message>
    <message>
        <source>no tour visits all {0} points by existing legs: {1}</source>
        <translation>kein Rundweg besucht alle {0} Punkte über vorhandene Strecken: {1}</translation>
    </message>
    <message>
        <source>no tour visits all {0} points: there is no way from point {1} to {2}</source>
        <translation>kein Rundweg besucht alle {0} Punkte: Von Punkt {1} führt kein Weg zu {2}</translation>
    </message>
    <message>
        <source>no tour visits all {0} points: there is only one leg at {1}</source>
        <translation>kein Rundweg besucht alle {0} Punkte: Nur eine Strecke hat {1}</translation>
    </message>
    <message>
        <source> and {0} more</source>
        <translation> und {0} weitere</translation>
    </message>
    <message>
        <source>points {0}</source>
        <translation>Punkte {0}</translation>
    </message>
    <message>
        <source>point {0}</source>
        <translation>Punkt {0}</translation>
    </message>
    <message>
        <source>speed through corners</source>
        <translation>Tempo durch Ecken</translation>
    </message>
    <message>
        <source>the aircraft stops at every vertex, where the closed form is exact</source>
        <translation>das Fluggerät hält an jeder Ecke, wo die geschlossene Formel genau ist</translation>
    </message>
    <message>
        <source>{0} of {1} vertices are flown through without a stop</source>
        <translation>{0} von {1} Ecken werden ohne Halt durchflogen</translation>
    </message>
    <message>
        <source>{0} may fly in wind below {1} m/s, but {2} m/s are expected; wait for less wind or take another aircraft</source>
        <translation>{0} darf bei Wind unter {1} m/s fliegen, erwartet werden aber {2} m/s; auf weniger Wind warten oder ein anderes Fluggerät nehmen</translation>
    </message>
    <message>
        <source>{0} flies {1} m/s and makes no headway against {2} m/s of wind; wait for less wind or take another aircraft</source>
        <translation>{0} fliegt {1} m/s und kommt gegen {2} m/s Wind nicht voran; auf weniger Wind warten oder ein anderes Fluggerät nehmen</translation>
    </message>
    <message>
        <source>a battery of {0} lasts {1} s; a reserve of {2} and {3} s for take-off and landing leave nothing; lower the reserve</source>
        <translation>ein Akku von {0} hält {1} s; eine Reserve von {2} und {3} s für Start und Landung lassen nichts übrig; die Reserve verkleinern</translation>
    </message>
    <message>
        <source>none of the viewpoints is locked; expected some with &quot;locked&quot;: true, which the Plan tab&apos;s lock sets</source>
        <translation>keiner der Aufnahmepunkte ist fixiert; erwartet wurden einige mit &quot;locked&quot;: true, was das Fixieren im Reiter Planung setzt</translation>
    </message>
    <message>
        <source>{0} views instead of the {1} asked for: more would show nothing new or could not be flown</source>
        <translation>{0} Aufnahmen statt der verlangten {1}: Mehr würden nichts Neues zeigen oder wären nicht zu fliegen</translation>
    </message>
    <message>
        <source>allow it more time</source>
        <translation>ihm mehr Zeit geben</translation>
    </message>
    <message>
        <source>the method flies a pattern of its own</source>
        <translation>das Verfahren fliegt ein eigenes Muster</translation>
    </message>
    <message>
        <source>the window is closing</source>
        <translation>das Fenster wird geschlossen</translation>
    </message>
    <message>
        <source>the system ended it, mostly because memory ran out</source>
        <translation>das System beendete ihn, meist weil der Speicher ausging</translation>
    </message>
    <message>
        <source>exit status {0}</source>
        <translation>Endstatus {0}</translation>
    </message>
    <message>
        <source>there is no planning method &apos;{0}&apos;; known are: {1}</source>
        <translation>es gibt kein Verfahren &apos;{0}&apos;; bekannt sind: {1}</translation>
    </message>
    <message>
        <source>the process that plans ended before the work was done ({0}); close other programs, or ask for less, and try again</source>
        <translation>der Prozess, der plant, endete vor der Arbeit ({0}); andere Programme schließen oder weniger verlangen und noch einmal versuchen</translation>
    </message>
    <message>
        <source>cancelled while {0}</source>
        <translation>abgebrochen bei: {0}</translation>
    </message>
    <message>
        <source>unsaved work could not be copied for after a crash: {0}. Nothing is lost while this window is open; make room or save the project in another folder</source>
        <translation>ungesicherte Arbeit ließ sich nicht für den Fall eines Absturzes kopieren: {0}. Solange dieses Fenster offen ist, geht nichts verloren; Platz schaffen oder das Projekt in einem anderen Ordner speichern</translation>
    </message>
    <message>
        <source>a plan</source>
        <translation>ein Plan</translation>
    </message>
    <message>
        <source>a site</source>
        <translation>ein Standort</translation>
    </message>
    <message>
        <source>a project</source>
        <translation>ein Projekt</translation>
    </message>
    <message>
        <source>a mission file</source>
        <translation>eine Missionsdatei</translation>
    </message>
    <message>
        <source>a building model</source>
        <translation>ein Gebäudemodell</translation>
    </message>
    <message>
        <source>a TSPLIB instance</source>
        <translation>eine TSPLIB-Aufgabe</translation>
    </message>
    <message>
        <source>a photo</source>
        <translation>ein Foto</translation>
    </message>
    <message>
        <source>a folder</source>
        <translation>ein Ordner</translation>
    </message>
    <message>
        <source>an empty file</source>
        <translation>eine leere Datei</translation>
    </message>
    <message>
        <source>nothing of that name</source>
        <translation>nichts dieses Namens</translation>
    </message>
    <message>
        <source>a file of another kind</source>
        <translation>eine Datei anderer Art</translation>
    </message>
    <message>
        <source>a plan file (such as office.plan.json)</source>
        <translation>eine Plandatei (etwa office.plan.json)</translation>
    </message>
    <message>
        <source>a site file (such as office.site.json)</source>
        <translation>eine Standortdatei (etwa office.site.json)</translation>
    </message>
    <message>
        <source>the folder of a project or its {0}</source>
        <translation>der Ordner eines Projekts oder dessen {0}</translation>
    </message>
    <message>
        <source>a mission file (.kmz, .plan, .waypoints, .kml or .csv)</source>
        <translation>eine Missionsdatei (.kmz, .plan, .waypoints, .kml oder .csv)</translation>
    </message>
    <message>
        <source>a TSPLIB instance (.tsp or .atsp)</source>
        <translation>eine TSPLIB-Aufgabe (.tsp oder .atsp)</translation>
    </message>
    <message>
        <source>a photo (JPEG, PNG, TIFF or BMP)</source>
        <translation>ein Foto (JPEG, PNG, TIFF oder BMP)</translation>
    </message>
    <message>
        <source>&apos;plan&apos; makes a plan of it</source>
        <translation>&apos;plan&apos; macht daraus einen Plan</translation>
    </message>
    <message>
        <source>name the site file that it was made for</source>
        <translation>die Standortdatei nennen, für die er gemacht wurde</translation>
    </message>
    <message>
        <source>it knows no building; name the site file that it is flown at</source>
        <translation>sie kennt kein Gebäude; die Standortdatei nennen, an der sie geflogen wird</translation>
    </message>
    <message>
        <source>&apos;project new&apos; makes a project of it</source>
        <translation>&apos;project new&apos; macht daraus ein Projekt</translation>
    </message>
    <message>
        <source>&apos;project add&apos; puts it into a project</source>
        <translation>&apos;project add&apos; legt es in ein Projekt</translation>
    </message>
    <message>
        <source>it needs no import; &apos;export&apos; makes a mission of it</source>
        <translation>er braucht keinen Import; &apos;export&apos; macht daraus eine Mission</translation>
    </message>
    <message>
        <source>it goes behind --site; name the mission file as well</source>
        <translation>er gehört hinter --site; auch die Missionsdatei nennen</translation>
    </message>
    <message>
        <source>it needs no import; &apos;plan&apos; takes it as it is</source>
        <translation>er braucht keinen Import; &apos;plan&apos; nimmt ihn, wie er ist</translation>
    </message>
    <message>
        <source>&apos;tradeoff route&apos; takes plans</source>
        <translation>&apos;tradeoff route&apos; nimmt Pläne</translation>
    </message>
    <message>
        <source>name a file in it</source>
        <translation>eine Datei darin nennen</translation>
    </message>
    <message>
        <source>check the path</source>
        <translation>den Pfad prüfen</translation>
    </message>
    <message>
        <source>expected {0}, found {1}; {2}</source>
        <translation>erwartet wurde {0}, gefunden: {1}; {2}</translation>
    </message>
    <message>
        <source>name another file</source>
        <translation>eine andere Datei nennen</translation>
    </message>
    <message>
        <source>its site is {0}</source>
        <translation>sein Standort ist {0}</translation>
    </message>
    <message>
        <source>name one of its plans: </source>
        <translation>einen seiner Pläne nennen: </translation>
    </message>
    <message>
        <source>it has no plan yet; &apos;plan {0} -o PLAN&apos; makes one</source>
        <translation>es hat noch keinen Plan; &apos;plan {0} -o PLAN&apos; macht einen</translation>
    </message>
    <message>
        <source>{0} was cancelled</source>
        <translation>{0} wurde abgebrochen</translation>
    </message>
    <message>
        <source>the map has no tiles; export it again with the area of the site</source>
        <translation>die Karte hat keine Kacheln; sie mit dem Gebiet des Standorts neu exportieren</translation>
    </message>
    <message>
        <source>expected zoom levels from 0 to {0}, found {1} to {2}</source>
        <translation>erwartet wurden Zoomstufen von 0 bis {0}, gefunden: {1} bis {2}</translation>
    </message>
    <message>
        <source>looking a tile up takes more than {0} s; the index on tiles is missing or the file is damaged; export the map again</source>
        <translation>eine Kachel nachzuschlagen dauert länger als {0} s; der Index der Kacheln fehlt, oder die Datei ist beschädigt; die Karte neu exportieren</translation>
    </message>
    <message>
        <source>not a map in MBTiles format, or damaged ({0}); choose another file, or export the map again</source>
        <translation>keine Karte im Format MBTiles oder beschädigt ({0}); eine andere Datei wählen oder die Karte neu exportieren</translation>
    </message>
    <message>
        <source>this folder cannot be written; changes can only be saved as another project</source>
        <translation>dieser Ordner ist nicht beschreibbar; Änderungen lassen sich nur als anderes Projekt speichern</translation>
    </message>
    <message>
        <source>the next plan</source>
        <translation>den nächsten Plan</translation>
    </message>
    <message>
        <source>there is no {0} here, so &apos;{1}&apos; and the plans beside it (found: {2}) were taken as a project; saving makes it one, with copies of its own</source>
        <translation>hier gibt es keine {0}, also gelten &apos;{1}&apos; und die Pläne daneben (gefunden: {2}) als Projekt; Speichern macht eines daraus, mit eigenen Kopien</translation>
    </message>
    <message>
        <source>this project is in format &apos;{0}&apos;; saving brings it to &apos;{1}&apos; and keeps the old {2} beside it</source>
        <translation>dieses Projekt hat das Format &apos;{0}&apos;; Speichern bringt es auf &apos;{1}&apos; und behält die alte {2} daneben</translation>
    </message>
    <message>
        <source>{0}; a project cannot be opened without its site: put the file back from a copy, or make a new project with &apos;project new&apos; and add the plans to it</source>
        <translation>{0}; ein Projekt lässt sich ohne seinen Standort nicht öffnen: Die Datei aus einer Kopie zurücklegen oder ein neues Projekt machen und die Pläne hineinlegen</translation>
    </message>
    <message>
        <source>there is a project here already; open it, or name another folder</source>
        <translation>hier ist schon ein Projekt; es öffnen oder einen anderen Ordner nennen</translation>
    </message>
    <message>
        <source>expected a folder for the project, found a file; name another folder</source>
        <translation>erwartet wurde ein Ordner für das Projekt, gefunden eine Datei; einen anderen Ordner nennen</translation>
    </message>
    <message>
        <source>a file</source>
        <translation>eine Datei</translation>
    </message>
    <message>
        <source>expected the folder of a project or its {0}, found {1}</source>
        <translation>erwartet wurde der Ordner eines Projekts oder dessen {0}, gefunden: {1}</translation>
    </message>
    <message>
        <source>would replace what holds a project together; name another file</source>
        <translation>würde ersetzen, was ein Projekt zusammenhält; eine andere Datei nennen</translation>
    </message>
    <message>
        <source>a newer Reflight wrote this project (format &apos;{0}&apos;, this one knows up to &apos;{1}&apos;); open it with that one</source>
        <translation>ein neueres Reflight schrieb dieses Projekt (Format &apos;{0}&apos;, dieses kennt sie bis &apos;{1}&apos;); mit jenem öffnen</translation>
    </message>
    <message>
        <source>cannot be saved: a number in it is NaN or infinite ({0})</source>
        <translation>nicht zu speichern: Eine Zahl darin ist NaN oder unendlich ({0})</translation>
    </message>
    <message>
        <source>process {0} on {1} since {2}</source>
        <translation>Prozess {0} auf {1} seit {2}</translation>
    </message>
    <message>
        <source>this project is open in another Reflight ({0}); close it there first, or copy the folder</source>
        <translation>dieses Projekt ist in einem anderen Reflight offen ({0}); es dort zuerst schließen oder den Ordner kopieren</translation>
    </message>
    <message>
        <source>expected the folder of a project, found nothing of that name</source>
        <translation>erwartet wurde der Ordner eines Projekts, gefunden: nichts dieses Namens</translation>
    </message>
    <message>
        <source>this project cannot be locked for editing ({0}); it can be looked at, and saved as another project</source>
        <translation>dieses Projekt lässt sich nicht zum Bearbeiten sperren ({0}); es lässt sich ansehen und als anderes Projekt speichern</translation>
    </message>
    <message>
        <source>there is no project in this folder: expected project.json, or a site file with plans beside it; &apos;project new&apos; makes a project</source>
        <translation>in diesem Ordner ist kein Projekt: erwartet wurde project.json oder eine Standortdatei mit Plänen daneben; einen Standort öffnen und als Projekt speichern</translation>
    </message>
    <message>
        <source>expected one site file in a folder without project.json, found {0} ({1}); make a project of one with &apos;project new&apos;</source>
        <translation>erwartet wurde eine Standortdatei in einem Ordner ohne project.json, gefunden: {0} ({1}); eine davon öffnen und als Projekt speichern</translation>
    </message>
    <message>
        <source>plans: expected a list of file names</source>
        <translation>plans: erwartet wurde eine Liste von Dateinamen</translation>
    </message>
    <message>
        <source>{0}; the plan &apos;{1}&apos; was left out</source>
        <translation>{0}; der Plan &apos;{1}&apos; wurde weggelassen</translation>
    </message>
    <message>
        <source>another program has changed the plan &apos;{0}&apos; since the project was saved</source>
        <translation>ein anderes Programm hat den Plan &apos;{0}&apos; geändert, seit das Projekt gespeichert wurde</translation>
    </message>
    <message>
        <source>the plan &apos;{0}&apos;</source>
        <translation>den Plan &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>{0}; what was asked of {1} was left out</source>
        <translation>{0}; was an {1} verlangt war, wurde weggelassen</translation>
    </message>
    <message>
        <source>{0}; how good the panels are was left out</source>
        <translation>{0}; wie gut die Scheiben sind, wurde weggelassen</translation>
    </message>
    <message>
        <source>plan &apos;{0}&apos;</source>
        <translation>Plan &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>the project holds this plan already, as &apos;{0}&apos;; leave it out</source>
        <translation>das Projekt enthält diesen Plan schon, als &apos;{0}&apos;; ihn weglassen</translation>
    </message>
    <message>
        <source>this plan was made for another state of the site, or for another site (&apos;{0}&apos;)</source>
        <translation>dieser Plan wurde für einen anderen Stand des Standorts oder für einen anderen Standort gemacht (&apos;{0}&apos;)</translation>
    </message>
    <message>
        <source>site &apos;{0}&apos;: cannot be saved: a text in it is no valid Unicode ({1})</source>
        <translation>Standort &apos;{0}&apos;: nicht zu speichern: Ein Text darin ist kein gültiges Unicode ({1})</translation>
    </message>
    <message>
        <source>{0}; this copy of unsaved work is damaged and cannot be taken over</source>
        <translation>{0}; diese Kopie ungesicherter Arbeit ist beschädigt und nicht zu übernehmen</translation>
    </message>
    <message>
        <source>all of it: it was never saved as a project</source>
        <translation>alles: es wurde nie als Projekt gespeichert</translation>
    </message>
    <message>
        <source>all of it: the project that was saved cannot be opened ({0})</source>
        <translation>alles: das gespeicherte Projekt lässt sich nicht öffnen ({0})</translation>
    </message>
    <message>
        <source>the site</source>
        <translation>der Standort</translation>
    </message>
    <message>
        <source>plan &apos;{0}&apos; is new</source>
        <translation>Plan &apos;{0}&apos; ist neu</translation>
    </message>
    <message>
        <source>plan &apos;{0}&apos; was changed</source>
        <translation>Plan &apos;{0}&apos; wurde geändert</translation>
    </message>
    <message>
        <source>plan &apos;{0}&apos; was removed</source>
        <translation>Plan &apos;{0}&apos; wurde entfernt</translation>
    </message>
    <message>
        <source>what is asked of the next plan</source>
        <translation>was vom nächsten Plan verlangt ist</translation>
    </message>
    <message>
        <source>; is &apos;{0}&apos; meant?</source>
        <translation>; ist &apos;{0}&apos; gemeint?</translation>
    </message>
    <message>
        <source>its settings are as at first, and the file stays as it is</source>
        <translation>die Einstellungen darin sind wie am Anfang, und die Datei bleibt, wie sie ist</translation>
    </message>
    <message>
        <source>its settings are as at first again, and the damaged file is kept as &apos;{0}&apos;</source>
        <translation>die Einstellungen darin sind wieder wie am Anfang, und die beschädigte Datei liegt als &apos;{0}&apos; daneben</translation>
    </message>
    <message>
        <source>expected one of {0}, found an unknown key{1}</source>
        <translation>erwartet wurde eines von {0}, gefunden ein unbekannter Schlüssel{1}</translation>
    </message>
    <message>
        <source>expected {0}, got {1}</source>
        <translation>erwartet wurde {0}, gefunden: {1}</translation>
    </message>
    <message>
        <source>a building model (.ifc, .gml, .xml, .json, .obj, .ply, .glb or .stl)</source>
        <translation>ein Gebäudemodell (.ifc, .gml, .xml, .json, .obj, .ply, .glb oder .stl)</translation>
    </message>
    <message>
        <source>import it first (&apos;import&apos;, or Mission &gt; Import mission files)</source>
        <translation>zuerst importieren (Mission &gt; Mission importieren)</translation>
    </message>
    <message>
        <source>import it first (&apos;site import&apos;, or Site &gt; Import), and plan a flight over that</source>
        <translation>zuerst importieren (Standort &gt; Importieren) und darüber einen Flug planen</translation>
    </message>
    <message>
        <source>import it first (&apos;site import&apos;, or Site &gt; Import)</source>
        <translation>zuerst importieren (Standort &gt; Importieren)</translation>
    </message>
    <message>
        <source>copy it again or make it anew</source>
        <translation>noch einmal kopieren oder neu machen</translation>
    </message>
    <message>
        <source>expected {0}, found a folder; name a file</source>
        <translation>erwartet wurde {0}, gefunden ein Ordner; eine Datei angeben</translation>
    </message>
    <message>
        <source>expected {0}, found a device or a pipe; name a file</source>
        <translation>erwartet wurde {0}, gefunden ein Gerät oder eine Pipe; eine Datei angeben</translation>
    </message>
    <message>
        <source>the file has more than {0}; expected {1}</source>
        <translation>die Datei hat mehr als {0}; erwartet wurde {1}</translation>
    </message>
    <message>
        <source>{0} MiB</source>
        <translation>{0} MiB</translation>
    </message>
    <message>
        <source>{0} KiB</source>
        <translation>{0} KiB</translation>
    </message>
    <message>
        <source>cannot be read: there is no such file</source>
        <translation>nicht lesbar: diese Datei gibt es nicht</translation>
    </message>
    <message>
        <source>has more than {0} lines; cut out the part that is wanted</source>
        <translation>hat mehr als {0} Zeilen; den gewünschten Teil ausschneiden</translation>
    </message>
    <message>
        <source>its content would take about {0} GiB of memory; expected at most {1} GiB; cut out the part that is wanted</source>
        <translation>der Inhalt bräuchte etwa {0} GiB Speicher; höchstens {1} GiB werden erwartet; den gewünschten Teil ausschneiden</translation>
    </message>
    <message>
        <source>the list of its files has more than {0}; pack it again with what is needed</source>
        <translation>die Liste der Dateien darin hat mehr als {0}; nur mit dem Nötigen neu packen</translation>
    </message>
    <message>
        <source>declares a document type or entities</source>
        <translation>deklariert einen Dokumenttyp oder Entitäten</translation>
    </message>
    <message>
        <source>is nested more than {0} levels deep</source>
        <translation>ist mehr als {0} Ebenen tief verschachtelt</translation>
    </message>
    <message>
        <source>a JSON file</source>
        <translation>eine JSON-Datei</translation>
    </message>
    <message>
        <source>expected a number of at most 20 digits, found one of {0}</source>
        <translation>erwartet wurde eine Zahl mit höchstens 20 Stellen, gefunden eine mit {0}</translation>
    </message>
    <message>
        <source>a TOML file</source>
        <translation>eine TOML-Datei</translation>
    </message>
    <message>
        <source>expected text, found half of a character (a surrogate by itself)</source>
        <translation>erwartet wurde Text, gefunden ein halbes Zeichen (ein einzelnes Surrogat)</translation>
    </message>
    <message>
        <source>a text in it holds half of a character (a surrogate by itself)</source>
        <translation>ein Text darin enthält ein halbes Zeichen (ein einzelnes Surrogat)</translation>
    </message>
    <message>
        <source>line {0}: a key has more than {1} parts; none of ours has</source>
        <translation>Zeile {0}: ein Schlüssel hat mehr als {1} Teile; keiner von uns hat so viele</translation>
    </message>
    <message>
        <source>a triangle names vertex {0}, which is not there (vertices: 0 to {1}); export the mesh again</source>
        <translation>ein Dreieck nennt die Ecke {0}, die es nicht gibt (Ecken: 0 bis {1}); das Netz neu exportieren</translation>
    </message>
    <message>
        <source>a mesh file</source>
        <translation>eine Netzdatei</translation>
    </message>
    <message>
        <source>reduce it, or cut out the building</source>
        <translation>verkleinern oder das Gebäude ausschneiden</translation>
    </message>
    <message>
        <source>this mesh would take about {0} GiB of memory; expected at most {1} GiB of one of its size; reduce it, or export the building alone as binary PLY</source>
        <translation>dieses Netz bräuchte etwa {0} GiB Speicher; höchstens {1} GiB werden von einem dieser Größe erwartet; verkleinern oder das Gebäude allein als binäres PLY exportieren</translation>
    </message>
    <message>
        <source>is no GLB file, or cut off; export it again</source>
        <translation>ist keine GLB-Datei oder abgeschnitten; neu exportieren</translation>
    </message>
    <message>
        <source>the GLB file does not begin with its description, or is cut off; export it again</source>
        <translation>die GLB-Datei beginnt nicht mit ihrer Beschreibung oder ist abgeschnitten; neu exportieren</translation>
    </message>
    <message>
        <source>the description in the GLB file is damaged ({0}); export it again</source>
        <translation>die Beschreibung in der GLB-Datei ist beschädigt ({0}); neu exportieren</translation>
    </message>
    <message>
        <source>its triangles are compressed ({0}), which is not read; export it without compression</source>
        <translation>die Dreiecke sind komprimiert ({0}), was nicht gelesen wird; ohne Kompression exportieren</translation>
    </message>
    <message>
        <source>its triangles are in another file; export it as one file, with everything in it</source>
        <translation>die Dreiecke liegen in einer anderen Datei; als eine Datei mit allem darin exportieren</translation>
    </message>
    <message>
        <source>its triangles are stored as differences from zero (sparse accessors), which is not read</source>
        <translation>die Dreiecke sind als Abweichungen von null gespeichert (sparse accessors), was nicht gelesen wird</translation>
    </message>
    <message>
        <source>a CityGML file</source>
        <translation>eine CityGML-Datei</translation>
    </message>
    <message>
        <source>cut out the buildings wanted</source>
        <translation>die gewünschten Gebäude ausschneiden</translation>
    </message>
    <message>
        <source>the XML {0}, which a CityGML file has no need of; refused</source>
        <translation>das XML {0}, was eine CityGML-Datei nicht braucht; abgelehnt</translation>
    </message>
    <message>
        <source>an IFC file</source>
        <translation>eine IFC-Datei</translation>
    </message>
    <message>
        <source>export the facade alone</source>
        <translation>nur die Fassade exportieren</translation>
    </message>
    <message>
        <source>{0}, which no mission needs; refused as hostile</source>
        <translation>{0}, was keine Mission braucht; als feindlich abgelehnt</translation>
    </message>
    <message>
        <source>a file of the signing key</source>
        <translation>eine Datei des Signaturschlüssels</translation>
    </message>
    <message>
        <source>a DJI KMZ</source>
        <translation>eine DJI-KMZ</translation>
    </message>
    <message>
        <source>a web page</source>
        <translation>eine Webseite</translation>
    </message>
    <message>
        <source>begin the training anew</source>
        <translation>das Training neu beginnen</translation>
    </message>
    <message>
        <source>the model cannot be written ({0})</source>
        <translation>das Modell lässt sich nicht schreiben ({0})</translation>
    </message>
    <message>
        <source>a picture</source>
        <translation>ein Bild</translation>
    </message>
    <message>
        <source>cannot be decoded as a picture; expected JPEG, PNG, WebP, TIFF or BMP, whole</source>
        <translation>lässt sich nicht als Bild lesen; JPEG, PNG, WebP, TIFF oder BMP wird erwartet, vollständig</translation>
    </message>
    <message>
        <source>the picture is cut off or damaged; copy the file again</source>
        <translation>das Bild ist abgeschnitten oder beschädigt; die Datei neu kopieren</translation>
    </message>
    <message>
        <source>claims to be a picture of {0} x {1} pixels; expected 1 to {2} megapixels, so it is not decoded</source>
        <translation>gibt sich als Bild von {0} x {1} Pixeln aus; 1 bis {2} Megapixel werden erwartet, darum wird es nicht gelesen</translation>
    </message>
    <message>
        <source>a document</source>
        <translation>ein Dokument</translation>
    </message>
    <message>
        <source>a safetensors file</source>
        <translation>eine safetensors-Datei</translation>
    </message>
    <message>
        <source>get the file again</source>
        <translation>die Datei neu beschaffen</translation>
    </message>
    <message>
        <source>is no safetensors file, or damaged (its header has no end); {0}</source>
        <translation>ist keine safetensors-Datei oder beschädigt (der Kopf hat kein Ende); {0}</translation>
    </message>
    <message>
        <source>is cut off or damaged ({0} of {1} bytes); {2}</source>
        <translation>ist abgeschnitten oder beschädigt ({0} von {1} Bytes); {2}</translation>
    </message>
    <message>
        <source>expected one table with an aircraft and its camera, got {0}</source>
        <translation>Erwartet wurde eine Tabelle mit einem Fluggerät und seiner Kamera, gefunden: {0}</translation>
    </message>
    <message>
        <source>there is no aircraft profile &apos;{0}&apos;; known are: {1}; your own can be a .toml file</source>
        <translation>Es gibt kein Profil eines Fluggeräts &apos;{0}&apos;; bekannt sind: {1}; ein eigenes kann eine .toml-Datei sein</translation>
    </message>
    <message>
        <source>cannot be read ({0})</source>
        <translation>nicht lesbar ({0})</translation>
    </message>
    <message>
        <source>expected JSON in UTF-8, found other bytes at offset {0}</source>
        <translation>erwartet wurde JSON in UTF-8, an Stelle {0} stehen andere Bytes</translation>
    </message>
    <message>
        <source>not valid JSON, line 1: the file is empty</source>
        <translation>kein gültiges JSON, Zeile 1: Die Datei ist leer</translation>
    </message>
    <message>
        <source>not valid JSON, line {0}, column {1}: {2}</source>
        <translation>kein gültiges JSON, Zeile {0}, Spalte {1}: {2}</translation>
    </message>
    <message>
        <source>nested too deeply for a file of ours</source>
        <translation>zu tief verschachtelt für eine unserer Dateien</translation>
    </message>
    <message>
        <source>holds a number with too many digits ({0})</source>
        <translation>enthält eine Zahl mit zu vielen Stellen ({0})</translation>
    </message>
    <message>
        <source>expected a finite number, got NaN or Infinity</source>
        <translation>erwartet wurde eine endliche Zahl, gefunden: NaN oder unendlich</translation>
    </message>
    <message>
        <source>format: expected &apos;{0}&apos;, got {1}; is it the right file?</source>
        <translation>format: erwartet wurde &apos;{0}&apos;, gefunden: {1}; ist es die richtige Datei?</translation>
    </message>
    <message>
        <source>not valid TOML ({0})</source>
        <translation>kein gültiges TOML ({0})</translation>
    </message>
    <message>
        <source>no such setting; known are: {0}</source>
        <translation>diese Einstellung gibt es nicht; bekannt sind: {0}</translation>
    </message>
    <message>
        <source>cannot be written: there is no folder &apos;{0}&apos;; make it first</source>
        <translation>nicht zu schreiben: Es gibt keinen Ordner &apos;{0}&apos;; ihn zuerst anlegen</translation>
    </message>
    <message>
        <source>cannot be written: this is a folder; name a file in it</source>
        <translation>nicht zu schreiben: Das ist ein Ordner; eine Datei darin nennen</translation>
    </message>
    <message>
        <source>not written: the name ends in {0}, and what would be in the file is {1}; name it so, or choose another format</source>
        <translation>nicht geschrieben: Der Name endet auf {0}, und in der Datei wäre {1}; nennen Sie sie so, oder wählen Sie ein anderes Format</translation>
    </message>
    <message>
        <source>would replace a {0} file by what is {1}; name another file</source>
        <translation>würde eine {0}-Datei durch {1} ersetzen; nennen Sie eine andere Datei</translation>
    </message>
    <message>
        <source>not written: the name ends in {0} as files do, and this is written as a folder; name one</source>
        <translation>nicht geschrieben: Der Name endet auf {0} wie bei Dateien, und geschrieben wird ein Ordner; nennen Sie einen</translation>
    </message>
    <message>
        <source>cannot be written: the file is write-protected; name another one</source>
        <translation>nicht zu schreiben: Die Datei ist schreibgeschützt; eine andere nennen</translation>
    </message>
    <message>
        <source>cannot be written: the folder &apos;{0}&apos; is write-protected; name a file in another one</source>
        <translation>nicht zu schreiben: Der Ordner &apos;{0}&apos; ist schreibgeschützt; eine Datei in einem anderen nennen</translation>
    </message>
    <message>
        <source>would replace {0}, which it is made from; name another file</source>
        <translation>würde {0} ersetzen, woraus es gemacht wird; eine andere Datei nennen</translation>
    </message>
    <message>
        <source>cannot be written ({0})</source>
        <translation>kann nicht geschrieben werden ({0})</translation>
    </message>
    <message>
        <source>expected a mesh file ({0}), got &apos;{1}&apos;</source>
        <translation>erwartet wurde eine Netzdatei ({0}), gefunden: &apos;{1}&apos;</translation>
    </message>
    <message>
        <source>there is no such mesh file</source>
        <translation>es gibt keine solche Netzdatei</translation>
    </message>
    <message>
        <source>this mesh cannot be read ({0})</source>
        <translation>dieses Netz ist nicht lesbar ({0})</translation>
    </message>
    <message>
        <source>the mesh has no triangles (a point cloud cannot serve as a building)</source>
        <translation>das Netz hat keine Dreiecke (eine Punktwolke taugt nicht als Gebäude)</translation>
    </message>
    <message>
        <source>the mesh has coordinates that are not finite numbers</source>
        <translation>das Netz hat Koordinaten, die keine endlichen Zahlen sind</translation>
    </message>
    <message>
        <source>the mesh has a coordinate of {0} m; local ENU metres near the site&apos;s origin are expected. Shift it (site import does) before using it</source>
        <translation>das Netz hat eine Koordinate von {0} m; erwartet werden örtliche Meter (ENU) nahe dem Nullpunkt des Standorts. Vorher verschieben (der Import eines Standorts tut das)</translation>
    </message>
    <message>
        <source>expected a positive number, got {0}</source>
        <translation>erwartet wurde eine positive Zahl, gefunden: {0}</translation>
    </message>
    <message>
        <source>expected [lowest, highest] within -180 to 90, got [{0}, {1}]</source>
        <translation>erwartet wurde [kleinste, größte] zwischen -180 und 90, gefunden: [{0}, {1}]</translation>
    </message>
    <message>
        <source>expected a name, got an empty text</source>
        <translation>erwartet wurde ein Name, gefunden: ein leerer Text</translation>
    </message>
    <message>
        <source>expected (-180, 180], got {0}</source>
        <translation>erwartet wurde (-180, 180], gefunden: {0}</translation>
    </message>
    <message>
        <source>expected -180 to 90, got {0}</source>
        <translation>erwartet wurde -180 bis 90, gefunden: {0}</translation>
    </message>
    <message>
        <source>expected 0 &lt;= covered &lt;= reachable_upper_bound &lt;= total, got {0}, {1}, {2}</source>
        <translation>erwartet wurde 0 &lt;= covered &lt;= reachable_upper_bound &lt;= total, gefunden: {0}, {1}, {2}</translation>
    </message>
    <message>
        <source>expected &apos;{0}&apos;, got &apos;{1}&apos;</source>
        <translation>erwartet wurde &apos;{0}&apos;, gefunden: &apos;{1}&apos;</translation>
    </message>
    <message>
        <source>expected unique ids, &apos;{0}&apos; occurs twice</source>
        <translation>erwartet wurden eindeutige Kennungen, &apos;{0}&apos; kommt zweimal vor</translation>
    </message>
    <message>
        <source>there is no viewpoint &apos;{0}&apos;</source>
        <translation>es gibt keinen Aufnahmepunkt &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>expected -90 to 90, got {0}</source>
        <translation>erwartet wurde -90 bis 90, gefunden: {0}</translation>
    </message>
    <message>
        <source>expected -180 to 180, got {0}</source>
        <translation>erwartet wurde -180 bis 180, gefunden: {0}</translation>
    </message>
    <message>
        <source>expected -1000 to 10000, got {0}</source>
        <translation>erwartet wurde -1000 bis 10000, gefunden: {0}</translation>
    </message>
    <message>
        <source>panel &apos;{0}&apos; has an area of {1} m2, so it has no normal; expected four corners in order around the pane</source>
        <translation>Scheibe &apos;{0}&apos; hat eine Fläche von {1} m2 und damit keine Normale; erwartet wurden vier Ecken der Reihe nach um die Scheibe</translation>
    </message>
    <message>
        <source>panel &apos;{0}&apos; is not flat, a corner lies {1} m off its mean plane; split it</source>
        <translation>Scheibe &apos;{0}&apos; ist nicht eben, eine Ecke liegt {1} m neben ihrer mittleren Ebene; sie teilen</translation>
    </message>
    <message>
        <source>panel &apos;{0}&apos; is not convex or its corners are not in order around the pane</source>
        <translation>Scheibe &apos;{0}&apos; ist nicht konvex, oder ihre Ecken stehen nicht der Reihe nach um die Scheibe</translation>
    </message>
    <message>
        <source>obstacle &apos;{0}&apos; needs its minimum corner first, got {1:m} and {2:m}</source>
        <translation>Hindernis &apos;{0}&apos; braucht zuerst seine kleinste Ecke, gefunden: {1:m} und {2:m}</translation>
    </message>
    <message>
        <source>zone &apos;{0}&apos; needs at least 3 corners, got {1}</source>
        <translation>Zone &apos;{0}&apos; braucht mindestens 3 Ecken, gefunden: {1}</translation>
    </message>
    <message>
        <source>zone &apos;{0}&apos; needs a ceiling above its floor ({1} m)</source>
        <translation>Zone &apos;{0}&apos; braucht eine Decke über ihrem Boden ({1} m)</translation>
    </message>
    <message>
        <source>zone &apos;{0}&apos; crosses itself or has no area</source>
        <translation>Zone &apos;{0}&apos; kreuzt sich selbst oder hat keine Fläche</translation>
    </message>
    <message>
        <source>the airspace is empty, {0} runs from {1} to {2} m</source>
        <translation>der Luftraum ist leer, {0} geht von {1} bis {2} m</translation>
    </message>
    <message>
        <source>expected unique panel ids, &apos;{0}&apos; occurs twice</source>
        <translation>erwartet wurden eindeutige Kennungen der Scheiben, &apos;{0}&apos; kommt zweimal vor</translation>
    </message>
    <message>
        <source>panels: a site without a building needs at least one panel; add the new ones first, then remove these</source>
        <translation>panels: Ein Standort ohne Gebäude braucht mindestens eine Scheibe; zuerst die neuen hinzufügen, dann diese entfernen</translation>
    </message>
    <message>
        <source>rally point</source>
        <translation>Rally-Punkt</translation>
    </message>
    <message>
        <source>aircraft can land at the rally points ({0})</source>
        <translation>Fluggeräte können an den Rally-Punkten landen ({0})</translation>
    </message>
    <message>
        <source>rally point &apos;{0}&apos; {1}</source>
        <translation>Rally-Punkt &apos;{0}&apos; {1}</translation>
    </message>
    <message>
        <source>is not below or inside the airspace; move it, or widen the airspace</source>
        <translation>liegt weder unter noch in dem Luftraum; versetzen oder den Luftraum erweitern</translation>
    </message>
    <message>
        <source>lies inside a building or obstacle; move it outside</source>
        <translation>liegt in einem Gebäude oder Hindernis; nach draußen versetzen</translation>
    </message>
    <message>
        <source>lies in a no-fly volume, or below one; move it outside</source>
        <translation>liegt in einem Flugverbotsraum oder darunter; nach draußen versetzen</translation>
    </message>
    <message>
        <source>has a landing column that comes within {0} m of the building or an obstacle, {1} m are required; move it away</source>
        <translation>hat eine Landesäule, die dem Gebäude oder einem Hindernis auf {0} m nahekommt, {1} m sind nötig; wegrücken</translation>
    </message>
    <message>
        <source>rally point &apos;{0}&apos; lies at {1} m, below the ground at {2} m; put it on the ground</source>
        <translation>Rally-Punkt &apos;{0}&apos; liegt auf {1} m, unter dem Boden auf {2} m; auf den Boden setzen</translation>
    </message>
    <message>
        <source>expected 0 or more, got {0}</source>
        <translation>erwartet wurde 0 oder mehr, gefunden: {0}</translation>
    </message>
    <message>
        <source>there is no bundled site &apos;{0}&apos;; known are: {1}</source>
        <translation>es gibt keinen mitgelieferten Standort &apos;{0}&apos;; bekannt sind: {1}</translation>
    </message>
    <message>
        <source>expected finite metres, {0} is {1}</source>
        <translation>erwartet wurden endliche Meter, {0} ist {1}</translation>
    </message>
    <message>
        <source>expected local ENU metres within {0} m of the origin, {1} is {2:m} (projected coordinates such as UTM must be shifted to the site&apos;s origin first)</source>
        <translation>erwartet wurden örtliche ENU-Koordinaten innerhalb von {0} m um den Nullpunkt, {1} ist {2:m} (projizierte Koordinaten wie UTM zuerst auf den Nullpunkt des Standorts verschieben)</translation>
    </message>
    <message>
        <source>obstacle &apos;{0}&apos;: expected either mesh or box_enu_m, got both or neither</source>
        <translation>Hindernis &apos;{0}&apos;: erwartet wurde mesh oder box_enu_m, gefunden: beides oder keins</translation>
    </message>
    <message>
        <source>obstacle &apos;{0}&apos; is a mesh, not a box</source>
        <translation>Hindernis &apos;{0}&apos; ist ein Netz, kein Quader</translation>
    </message>
    <message>
        <source>expected at least one panel, or a building_mesh on which panels can be found, got neither; add panels, or name the mesh of the building</source>
        <translation>erwartet mindestens eine Scheibe oder ein building_mesh, auf dem Scheiben gefunden werden können, gefunden keines von beiden; Scheiben hinzufügen oder das Netz des Gebäudes nennen</translation>
    </message>
    <message>
        <source>site &apos;{0}&apos; has no panels yet: find them in photos (&apos;panels&apos; or the Photos tab), or draw them on the building (the Site tab, or &apos;site import&apos; with --panel-grid)</source>
        <translation>Standort &apos;{0}&apos; hat noch keine Scheiben: in Fotos suchen (&apos;panels&apos; oder Reiter Fotos) oder auf das Gebäude zeichnen (Reiter Standort oder &apos;site import&apos; mit --panel-grid)</translation>
    </message>
    <message>
        <source>there are no panels yet: find them in photos (Photos tab), or draw a panel grid on the building</source>
        <translation>es gibt noch keine Scheiben: in Fotos suchen (Reiter Fotos) oder ein Scheibenraster auf das Gebäude zeichnen</translation>
    </message>
    <message>
        <source>expected {0} obstacle meshes, got {1}</source>
        <translation>erwartet wurden {0} Hindernisnetze, gefunden: {1}</translation>
    </message>
    <message>
        <source>{0}; mesh paths start from the folder of the site file</source>
        <translation>{0}; Pfade von Netzen beginnen im Ordner der Standortdatei</translation>
    </message>
    <message>
        <source>no-fly zone</source>
        <translation>Flugverbotszone</translation>
    </message>
    <message>
        <source>sea level</source>
        <translation>Meeresspiegel</translation>
    </message>
    <message>
        <source>expected the first value below the second, got {0} m and {1} m</source>
        <translation>erwartet wurde der erste Wert kleiner als der zweite, gefunden: {0} m und {1} m</translation>
    </message>
    <message>
        <source>name: expected a name for the {0}, got an empty text</source>
        <translation>Name: erwartet wurde ein Name, gefunden ein leerer Text ({0})</translation>
    </message>
    <message>
        <source>name: there is a {0} &apos;{1}&apos; already; choose another name</source>
        <translation>Name: es gibt diesen Namen schon ({0} &apos;{1}&apos;); einen anderen wählen</translation>
    </message>
    <message>
        <source>the airspace begins at {0} m, below the ground at {1} m; raise its floor</source>
        <translation>der Luftraum beginnt bei {0} m, unter dem Boden bei {1} m; seinen Boden anheben</translation>
    </message>
    <message>
        <source>home lies at {0} m, below the ground at {1} m; put it on the ground</source>
        <translation>der Startplatz liegt bei {0} m, unter dem Boden bei {1} m; ihn auf den Boden setzen</translation>
    </message>
    <message>
        <source>no-fly zone &apos;{0}&apos; lies outside the airspace, so it changes nothing</source>
        <translation>die Flugverbotszone &apos;{0}&apos; liegt außerhalb des Luftraums und ändert also nichts</translation>
    </message>
    <message>
        <source>facade &apos;{0}&apos;: there is no free airspace {1} to {2} m in front of its panels ({3}) from which they are seen; turn it to the other side, widen the airspace, or remove it</source>
        <translation>Fassade &apos;{0}&apos;: Es gibt {1} bis {2} m vor ihren Scheiben ({3}) keinen freien Luftraum, von dem aus sie zu sehen sind; sie auf die andere Seite drehen, den Luftraum erweitern oder sie entfernen</translation>
    </message>
    <message>
        <source>which may be off by 1 m, in mountains by 2 m</source>
        <translation>das um 1 m falsch sein kann, in Bergen um 2 m</translation>
    </message>
    <message>
        <source>the point {0} has no position in {1}; is this the system the file is in?</source>
        <translation>der Punkt {0} hat keine Lage in {1}; ist das wirklich das System der Datei?</translation>
    </message>
    <message>
        <source>(east, north)</source>
        <translation>(Ost, Nord)</translation>
    </message>
    <message>
        <source>(north, east)</source>
        <translation>(Nord, Ost)</translation>
    </message>
    <message>
        <source>coordinates are read as {0}, as they fit; {1} itself lists {2}</source>
        <translation>Koordinaten werden als {0} gelesen, denn so passen sie; {1} selbst nennt {2}</translation>
    </message>
    <message>
        <source> and as </source>
        <translation> und als </translation>
    </message>
    <message>
        <source>the coordinates ({0}, {1}), read as {2}, lie far outside the area of use of {3}; name the right system with --crs</source>
        <translation>die Koordinaten ({0}, {1}), gelesen als {2}, liegen weit außerhalb des Geltungsbereichs von {3}; das richtige System mit --crs nennen</translation>
    </message>
    <message>
        <source>no transformation to WGS 84 of known accuracy is installed; convert the file to a system on WGS 84 or ETRS89 first (a UTM zone, say)</source>
        <translation>keine Umrechnung nach WGS 84 mit bekannter Genauigkeit ist installiert; die Datei zuerst in ein System auf WGS 84 oder ETRS89 umrechnen (etwa eine UTM-Zone)</translation>
    </message>
    <message>
        <source>coordinates are in {0}</source>
        <translation>Koordinaten sind in {0}</translation>
    </message>
    <message>
        <source>; &apos;{0}&apos; is accurate to about {1} m, by which the whole site may be displaced</source>
        <translation>; &apos;{0}&apos; ist auf etwa {1} m genau, und um so viel kann der ganze Standort verschoben sein</translation>
    </message>
    <message>
        <source> (a finer one, {0} m, needs the grid {1})</source>
        <translation> (eine feinere, {0} m, braucht das Gitter {1})</translation>
    </message>
    <message>
        <source>EGM96, here {0} m above the ellipsoid</source>
        <translation>EGM96, hier {0} m über dem Ellipsoid</translation>
    </message>
    <message>
        <source>{0}, stands in for the national geoid, {1}</source>
        <translation>{0}, steht für das nationale Geoid, {1}</translation>
    </message>
    <message>
        <source>heights are taken above the ellipsoid, as you asked, not as {0}</source>
        <translation>Höhen zählen wie verlangt über dem Ellipsoid, nicht als {0}</translation>
    </message>
    <message>
        <source>heights are above the geoid of {0}</source>
        <translation>Höhen sind über dem Geoid von {0}</translation>
    </message>
    <message>
        <source>heights are in the system &apos;{0}&apos;; {1}</source>
        <translation>Höhen sind im System &apos;{0}&apos;; {1}</translation>
    </message>
    <message>
        <source>heights are above the ellipsoid, as the system says</source>
        <translation>Höhen sind über dem Ellipsoid, wie das System sagt</translation>
    </message>
    <message>
        <source> in the unit of the other coordinates ({0})</source>
        <translation> in der Einheit der übrigen Koordinaten ({0})</translation>
    </message>
    <message>
        <source>heights are taken above the ellipsoid{0}, as you asked</source>
        <translation>Höhen zählen über dem Ellipsoid{0}, wie verlangt</translation>
    </message>
    <message>
        <source>as you asked</source>
        <translation>wie verlangt</translation>
    </message>
    <message>
        <source>as the system has none of its own (see --height-reference)</source>
        <translation>denn das System hat keine eigenen (siehe --height-reference)</translation>
    </message>
    <message>
        <source>heights are taken above sea level{0}, {1}; {2}</source>
        <translation>Höhen zählen über dem Meeresspiegel{0}, {1}; {2}</translation>
    </message>
    <message>
        <source>&apos;{0}&apos; is not a coordinate reference system known here; expected a code such as EPSG:25832, EPSG:7415 or EPSG:25832+7837</source>
        <translation>&apos;{0}&apos; ist kein hier bekanntes Koordinatensystem; erwartet wurde ein Code wie EPSG:25832, EPSG:7415 oder EPSG:25832+7837</translation>
    </message>
    <message>
        <source>&apos;{0}&apos; is a {1}; expected a projected or geographic system</source>
        <translation>&apos;{0}&apos; ist ein {1}; erwartet wurde ein projiziertes oder geographisches System</translation>
    </message>
    <message>
        <source>there is no building with surfaces in this file</source>
        <translation>in dieser Datei ist kein Gebäude mit Flächen</translation>
    </message>
    <message>
        <source>other buildings in the file: {0} within reach of the airspace, kept as obstacles; {1} further away, left out</source>
        <translation>weitere Gebäude in der Datei: {0} in Reichweite des Luftraums, als Hindernisse behalten; {1} weiter weg, weggelassen</translation>
    </message>
    <message>
        <source>windows given as a shared prototype (implicit geometry), not read: {0}</source>
        <translation>Fenster als gemeinsame Vorlage (implizite Geometrie), nicht gelesen: {0}</translation>
    </message>
    <message>
        <source>there is no building &apos;{0}&apos;; there are {1}</source>
        <translation>es gibt kein Gebäude &apos;{0}&apos;; es gibt {1}</translation>
    </message>
    <message>
        <source>the panel grid is on building &apos;{0}&apos;</source>
        <translation>das Scheibenraster liegt auf Gebäude &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>no building in the file has windows; &apos;{0}&apos; has the most surfaces</source>
        <translation>kein Gebäude in der Datei hat Fenster; &apos;{0}&apos; hat die meisten Flächen</translation>
    </message>
    <message>
        <source>the site is {0}</source>
        <translation>der Standort ist {0}</translation>
    </message>
    <message>
        <source>; {0} further away, to be imported with --building ID</source>
        <translation>; {0} weiter weg, einzeln zu importieren mit --building ID</translation>
    </message>
    <message>
        <source> (windows: {0})</source>
        <translation> (Fenster: {0})</translation>
    </message>
    <message>
        <source>expected a CityGML file (root element CityModel), found &apos;{0}&apos;</source>
        <translation>erwartet wurde eine CityGML-Datei (Wurzelelement CityModel), gefunden: &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>building {0}</source>
        <translation>Gebäude {0}</translation>
    </message>
    <message>
        <source>not valid XML ({0})</source>
        <translation>kein gültiges XML ({0})</translation>
    </message>
    <message>
        <source>nested too deeply for a CityGML file</source>
        <translation>zu tief verschachtelt für eine CityGML-Datei</translation>
    </message>
    <message>
        <source>the building would be {0:m} x {1:m} x {2} m, at most {3} km are expected; {4}</source>
        <translation>das Gebäude wäre {0:m} x {1:m} x {2} m groß, erwartet werden höchstens {3} km; {4}</translation>
    </message>
    <message>
        <source>the model is {0:m} x {1:m} x {2} m, implausibly small for a building: {3}</source>
        <translation>das Modell ist {0:m} x {1:m} x {2} m groß, für ein Gebäude unglaubwürdig klein: {3}</translation>
    </message>
    <message>
        <source>the model is {0:m} x {1:m} x {2} m, implausibly large for a building: {3}</source>
        <translation>das Modell ist {0:m} x {1:m} x {2} m groß, für ein Gebäude unglaubwürdig groß: {3}</translation>
    </message>
    <message>
        <source>the unit or the scale that the file states is wrong; put it right in the program that wrote it</source>
        <translation>die Einheit oder der Maßstab, den die Datei angibt, ist falsch; in dem Programm berichtigen, das sie geschrieben hat</translation>
    </message>
    <message>
        <source>if its unit is not what was read, {0}</source>
        <translation>falls die Einheit nicht die gelesene ist: {0}</translation>
    </message>
    <message>
        <source>--units {0} makes it {1:m} x {2:m} x {3} m (factor {4})</source>
        <translation>mit --units {0} wären es {1:m} x {2:m} x {3} m (Faktor {4})</translation>
    </message>
    <message>
        <source>no unit makes it plausible, so it is no model of true size; scale it in the program that wrote it</source>
        <translation>keine Einheit macht es glaubwürdig, es ist also kein Modell in wahrer Größe; in dem Programm skalieren, das es geschrieben hat</translation>
    </message>
    <message>
        <source>left out, because they are broken (such as outlines of fewer than three points) or not read: {0} ({1})</source>
        <translation>weggelassen, weil beschädigt (etwa Umrisse aus weniger als drei Punkten) oder nicht lesbar: {0} ({1})</translation>
    </message>
    <message>
        <source>without an identifier</source>
        <translation>ohne Kennung</translation>
    </message>
    <message>
        <source>building &apos;{0}&apos; has no surface with an area</source>
        <translation>das Gebäude &apos;{0}&apos; hat keine Fläche mit Ausdehnung</translation>
    </message>
    <message>
        <source>{0}; where the coordinates are local ones, give --origin LAT,LON,HEIGHT (of their zero point)</source>
        <translation>{0}; falls die Koordinaten örtliche sind, --origin LAT,LON,HEIGHT (ihres Nullpunkts) angeben</translation>
    </message>
    <message>
        <source>left out as strays, below the ground or far from everything else: {0} triangles, from {1} to {2} in the file&apos;s heights</source>
        <translation>als verirrt weggelassen, unter dem Boden oder fern von allem anderen: {0} Dreiecke, von {1} bis {2} in den Höhen der Datei</translation>
    </message>
    <message>
        <source>ground: z = {0} of the file, where the outer walls end, as there is no ground around the building in the file (--ground names another)</source>
        <translation>Boden: z = {0} der Datei, wo die Außenwände enden, denn die Datei enthält keinen Boden um das Gebäude (--ground nennt einen anderen)</translation>
    </message>
    <message>
        <source>ground: z = {0} of the file, by the open ground along {1} % of the building&apos;s outline, which lies between {2} and {3} (--ground names another)</source>
        <translation>Boden: z = {0} der Datei, nach dem freien Boden entlang {1} % des Gebäudeumrisses, der zwischen {2} und {3} liegt (--ground nennt einen anderen)</translation>
    </message>
    <message>
        <source>ground: along the building&apos;s outline it lies between z = {0} and {1} of the file; the highest is taken, so that heights above ground are safe on every side (--ground names another)</source>
        <translation>Boden: entlang des Gebäudeumrisses liegt er zwischen z = {0} und {1} der Datei; der höchste gilt, damit Höhen über Boden auf jeder Seite sicher sind (--ground nennt einen anderen)</translation>
    </message>
    <message>
        <source>ground: z = {0} of the file, its GroundSurface (--ground names another)</source>
        <translation>Boden: z = {0} der Datei, ihre GroundSurface (--ground nennt einen anderen)</translation>
    </message>
    <message>
        <source>ground: the file&apos;s GroundSurface lies between z = {0} and {1}; the highest is taken, so that heights above ground are safe on every side (--ground names another)</source>
        <translation>Boden: die GroundSurface der Datei liegt zwischen z = {0} und {1}; die höchste gilt, damit Höhen über Boden auf jeder Seite sicher sind (--ground nennt einen anderen)</translation>
    </message>
    <message>
        <source>ground: z = {0} of the model, the zero of IfcSite (--ground names another)</source>
        <translation>Boden: z = {0} des Modells, die Null von IfcSite (--ground nennt einen anderen)</translation>
    </message>
    <message>
        <source>the file shows neither open ground around the building nor walls that reach down to it; its lowest surface is at z = {0}. Name the height of the ground in the file with --ground Z</source>
        <translation>die Datei zeigt weder freien Boden um das Gebäude noch Wände, die bis zu ihm reichen; ihre tiefste Fläche liegt bei z = {0}. Die Höhe des Bodens in der Datei mit --ground Z angeben</translation>
    </message>
    <message>
        <source>two heights of the file may be the ground: {0}. Say which with --ground {1} or --ground {2}</source>
        <translation>zwei Höhen der Datei können der Boden sein: {0}. Mit --ground {1} oder --ground {2} sagen, welche</translation>
    </message>
    <message>
        <source>z = {0}, where the building&apos;s foot is, and z = {1}, a deck all around its upper part</source>
        <translation>z = {0}, der Fuß des Gebäudes, und z = {1}, eine Plattform rings um seinen oberen Teil</translation>
    </message>
    <message>
        <source>z = {0}, where its lowest outer walls end, and z = {1}, where others do (a cellar, a slope, a torn edge, or storeys that hang over)</source>
        <translation>z = {0}, wo seine tiefsten Außenwände enden, und z = {1}, wo andere enden (ein Keller, ein Hang, ein ausgefranster Rand oder auskragende Geschosse)</translation>
    </message>
    <message>
        <source>expected a CityJSON file (with &quot;type&quot;: &quot;CityJSON&quot;)</source>
        <translation>erwartet wurde eine CityJSON-Datei (mit &quot;type&quot;: &quot;CityJSON&quot;)</translation>
    </message>
    <message>
        <source>expected CityJSON version {0}, got &apos;{1}&apos;</source>
        <translation>erwartet wurde CityJSON in Version {0}, gefunden: &apos;{1}&apos;</translation>
    </message>
    <message>
        <source>this CityJSON file is broken ({0}: {1})</source>
        <translation>diese CityJSON-Datei ist beschädigt ({0}: {1})</translation>
    </message>
    <message>
        <source>this IFC file cannot be read ({0}); IFC 2x3, IFC 4 and IFC 4.3 are read</source>
        <translation>diese IFC-Datei ist nicht lesbar ({0}); gelesen werden IFC 2x3, IFC 4 und IFC 4.3</translation>
    </message>
    <message>
        <source>this IFC file is broken ({0}: {1})</source>
        <translation>diese IFC-Datei ist beschädigt ({0}: {1})</translation>
    </message>
    <message>
        <source>windows: {0}; plates: {1}, of which glazed: {2}</source>
        <translation>Fenster: {0}; Platten: {1}, davon verglast: {2}</translation>
    </message>
    <message>
        <source>windows left out because they have no geometry: {0}</source>
        <translation>Fenster weggelassen, weil sie keine Geometrie haben: {0}</translation>
    </message>
    <message>
        <source>--deflection {0}: expected a positive length in metres</source>
        <translation>--deflection {0}: erwartet wurde eine positive Länge in Metern</translation>
    </message>
    <message>
        <source>no building element in this file has geometry</source>
        <translation>kein Bauteil in dieser Datei hat Geometrie</translation>
    </message>
    <message>
        <source>expected an IFC file (STEP text that begins with ISO-10303-21)</source>
        <translation>erwartet wurde eine IFC-Datei (STEP-Text, der mit ISO-10303-21 beginnt)</translation>
    </message>
    <message>
        <source>the file is cut off (END-ISO-10303-21 is missing); copy or export it again</source>
        <translation>die Datei ist abgeschnitten (END-ISO-10303-21 fehlt); noch einmal kopieren oder exportieren</translation>
    </message>
    <message>
        <source>the map conversion is left aside ({0})</source>
        <translation>die Kartenabbildung bleibt unbeachtet ({0})</translation>
    </message>
    <message>
        <source>the map conversion names no coordinate reference system; give it with --crs EPSG:CODE</source>
        <translation>die Kartenabbildung nennt kein Koordinatensystem; es mit --crs EPSG:CODE angeben</translation>
    </message>
    <message>
        <source>place and rotation from IfcMapConversion</source>
        <translation>Ort und Drehung aus IfcMapConversion</translation>
    </message>
    <message>
        <source>the scale of IfcMapConversion leaves out the change of units, which is put right</source>
        <translation>der Maßstab von IfcMapConversion lässt den Wechsel der Einheit aus; das ist berichtigt</translation>
    </message>
    <message>
        <source>IfcMapConversion has the scale {0}, which is neither near 1 nor the change of units ({1}); give the place with --origin</source>
        <translation>IfcMapConversion hat den Maßstab {0}, der weder nahe 1 noch der Wechsel der Einheit ({1}) ist; den Ort mit --origin angeben</translation>
    </message>
    <message>
        <source>place from latitude and longitude of IfcSite, which is often just the city that the BIM program assumes: check it, or give --origin</source>
        <translation>Ort aus Breite und Länge von IfcSite, was oft nur die Stadt ist, die das BIM-Programm annimmt: prüfen oder --origin angeben</translation>
    </message>
    <message>
        <source>elevation of IfcSite ({0} m) is above sea level; EGM96, here {1} m above the ellipsoid, makes it ellipsoidal, to about 1 m</source>
        <translation>die Höhe von IfcSite ({0} m) ist über dem Meeresspiegel; EGM96, hier {1} m über dem Ellipsoid, macht sie ellipsoidisch, auf etwa 1 m</translation>
    </message>
    <message>
        <source>true north is {0} degrees counter-clockwise from the model&apos;s y axis</source>
        <translation>geografisch Nord liegt {0}° gegen den Uhrzeigersinn von der y-Achse des Modells</translation>
    </message>
    <message>
        <source>IfcSite lies at latitude {0}, longitude {1}, which is nowhere on earth; give --origin</source>
        <translation>IfcSite liegt bei Breite {0}, Länge {1}, also nirgends auf der Erde; --origin angeben</translation>
    </message>
    <message>
        <source>the geometry kernel crashed on this IFC file (status {0}), so something in it goes in circles or beyond all bounds; open and export it again in a BIM program</source>
        <translation>der Geometriekern stürzte an dieser IFC-Datei ab (Status {0}), also geht etwas darin im Kreis oder über alle Grenzen; sie in einem BIM-Programm öffnen und neu exportieren</translation>
    </message>
    <message>
        <source>no window of {0} is a pane that faces the open</source>
        <translation>kein Fenster von {0} ist eine Scheibe, die ins Freie blickt</translation>
    </message>
    <message>
        <source>there are no windows</source>
        <translation>es gibt keine Fenster</translation>
    </message>
    <message>
        <source>{0}, so the site has no panels yet: find them in photos (&apos;panels&apos; or the Photos tab), or draw them on the building (the Site tab, or --panel-grid)</source>
        <translation>{0}, daher hat der Standort noch keine Scheiben: in Fotos suchen (&apos;panels&apos; oder Reiter Fotos) oder auf das Gebäude zeichnen (Reiter Standort oder --panel-grid)</translation>
    </message>
    <message>
        <source>expected a file ending in {0}, got &apos;{1}&apos;</source>
        <translation>erwartet wurde eine Datei mit der Endung {0}, gefunden: &apos;{1}&apos;</translation>
    </message>
    <message>
        <source>there is no such file</source>
        <translation>es gibt keine solche Datei</translation>
    </message>
    <message>
        <source>ground: the file holds windows alone, the lowest at z = {0}, which is taken; check it (--ground)</source>
        <translation>Boden: die Datei enthält nur Fenster, das tiefste bei z = {0}, was gilt; bitte prüfen (--ground)</translation>
    </message>
    <message>
        <source>facades, by plane or smoothly curved surface: {0}, the one with most glass first (A: {1} panels, {2} m2)</source>
        <translation>Fassaden, nach Ebene oder sanft gekrümmter Fläche: {0}, die mit dem meisten Glas zuerst (A: {1} Scheiben, {2} m2)</translation>
    </message>
    <message>
        <source>; with one panel only: {0}</source>
        <translation>; mit nur einer Scheibe: {0}</translation>
    </message>
    <message>
        <source>{0} % of the building&apos;s surface does not close (gaps and overlaps in the model): the distance to it is kept all the same, but the space behind it does not count as solid</source>
        <translation>{0} % der Gebäudeoberfläche schließen nicht (Lücken und Überlappungen im Modell): Der Abstand dazu wird trotzdem eingehalten, der Raum dahinter gilt aber nicht als fest</translation>
    </message>
    <message>
        <source>axes: {0} is up</source>
        <translation>Achsen: {0} zeigt nach oben</translation>
    </message>
    <message>
        <source> (glTF&apos;s rule)</source>
        <translation> (Regel von glTF)</translation>
    </message>
    <message>
        <source>lengths are in {0} (--units)</source>
        <translation>Längen sind in {0} (--units)</translation>
    </message>
    <message>
        <source>--units and --crs both say what the coordinates are in; the system of --crs has its own units</source>
        <translation>--units und --crs sagen beide, worin die Koordinaten sind; das System von --crs hat seine eigenen Einheiten</translation>
    </message>
    <message>
        <source>the file stores coordinates this far from zero in steps of {0} m (single precision), so the building&apos;s shape is that rough; export it again with a local offset</source>
        <translation>die Datei hält Koordinaten so weit von null in Schritten von {0} m (einfache Genauigkeit), so grob ist also die Form des Gebäudes; mit örtlichem Versatz neu exportieren</translation>
    </message>
    <message>
        <source>; check the corners, --units and --up, or allow more with --grid-tolerance</source>
        <translation>; die Ecken, --units und --up prüfen oder mit --grid-tolerance mehr erlauben</translation>
    </message>
    <message>
        <source>expected 1 to {0} panels in all, got {1} rows and {2} columns</source>
        <translation>erwartet wurden 1 bis {0} Scheiben insgesamt, gefunden: {1} Zeilen und {2} Spalten</translation>
    </message>
    <message>
        <source>the rectangle is {0} x {1} m, no facade; place its corners apart</source>
        <translation>das Rechteck ist {0} x {1} m groß, das ist keine Fassade; seine Ecken weiter auseinander setzen</translation>
    </message>
    <message>
        <source>the angle at the lower left corner is {0} degrees; expected a rectangle, given by its lower left, lower right and upper left corner as seen from outside</source>
        <translation>der Winkel an der unteren linken Ecke ist {0}°; erwartet wurde ein Rechteck, gegeben durch untere linke, untere rechte und obere linke Ecke, von außen gesehen</translation>
    </message>
    <message>
        <source>a gap of {0} m leaves no glass between the mullions: the grid&apos;s cells measure {1} x {2} m</source>
        <translation>eine Fuge von {0} m lässt zwischen den Pfosten kein Glas: die Felder des Rasters messen {1} x {2} m</translation>
    </message>
    <message>
        <source>its panels lie {0} m from the building (median; nearest {1} m, allowed {2} m). In local metres the grid&apos;s middle is {3} and the building reaches from {4} to {5}</source>
        <translation>seine Scheiben liegen {0} m vom Gebäude (Median; nächste {1} m, erlaubt {2} m). In örtlichen Metern ist die Mitte des Rasters {3}, und das Gebäude reicht von {4} bis {5}</translation>
    </message>
    <message>
        <source>{0} of {1} panels look into the building, and their backs look out; name the corners as seen from outside (lower left, lower right, upper left)</source>
        <translation>{0} von {1} Scheiben blicken ins Gebäude, und ihre Rückseiten nach außen; die Ecken wie von außen gesehen nennen (untere linke, untere rechte, obere linke)</translation>
    </message>
    <message>
        <source>{0} of {1} panels of the grid see nothing of the open, as the mesh covers them: move the grid outwards, or they cannot be photographed with occlusion on</source>
        <translation>{0} von {1} Scheiben des Rasters sehen nichts vom Freien, denn das Netz verdeckt sie: Das Raster nach außen rücken, sonst sind sie mit Verdeckung nicht zu fotografieren</translation>
    </message>
    <message>
        <source>windows left out as slivers or without area</source>
        <translation>Fenster weggelassen als Splitter oder ohne Fläche</translation>
    </message>
    <message>
        <source>windows left out as indoor ones, which see nothing of the open</source>
        <translation>Fenster weggelassen als innenliegend; sie sehen nichts vom Freien</translation>
    </message>
    <message>
        <source>windows left out because another one shows the same pane</source>
        <translation>Fenster weggelassen, weil ein anderes dieselbe Scheibe zeigt</translation>
    </message>
    <message>
        <source>windows that lie exactly on others, where both stay</source>
        <translation>Fenster, die genau auf anderen liegen; beide bleiben</translation>
    </message>
    <message>
        <source>windows that are no quads, for which a rectangle of the same area stands in</source>
        <translation>Fenster, die keine Vierecke sind; ein Rechteck gleicher Fläche steht für sie</translation>
    </message>
    <message>
        <source>windows that the file has facing into the building, turned around</source>
        <translation>Fenster, die in der Datei ins Gebäude zeigen, umgedreht</translation>
    </message>
    <message>
        <source>windows open on both sides, taken to face away from the building</source>
        <translation>Fenster, die nach beiden Seiten offen sind; angenommen ist, dass sie vom Gebäude weg blicken</translation>
    </message>
    <message>
        <source>{0} m in front of the panels the building hides {1} % of the directions (worst panel {2} %); their own frames and reveals hide {3} % (worst {4} %)</source>
        <translation>{0} m vor den Scheiben verdeckt das Gebäude {1} % der Richtungen (schlechteste Scheibe {2} %); ihre eigenen Rahmen und Laibungen verdecken {3} % (schlechteste {4} %)</translation>
    </message>
    <message>
        <source>--origin and --crs both say where the file is; give one of them</source>
        <translation>--origin und --crs sagen beide, wo die Datei liegt; eines davon angeben</translation>
    </message>
    <message>
        <source>the file does not say where on earth it is; give --origin LAT,LON,HEIGHT (of its zero point) or --crs EPSG:CODE (of its coordinates)</source>
        <translation>die Datei sagt nicht, wo auf der Erde sie liegt; --origin LAT,LON,HEIGHT (ihres Nullpunkts) oder --crs EPSG:CODE (ihrer Koordinaten) angeben</translation>
    </message>
    <message>
        <source>the building lies {0} km from the point whose place the file gives, so its coordinates are projected ones; name their system with --crs EPSG:CODE</source>
        <translation>das Gebäude liegt {0} km von dem Punkt, dessen Ort die Datei angibt, also sind ihre Koordinaten projiziert; ihr System mit --crs EPSG:CODE nennen</translation>
    </message>
    <message>
        <source>the building would stand at an impossible place ({0}); check --crs and units</source>
        <translation>das Gebäude stünde an einem unmöglichen Ort ({0}); --crs und die Einheit prüfen</translation>
    </message>
    <message>
        <source>its height is above the ellipsoid (--height-reference orthometric for sea level)</source>
        <translation>seine Höhe ist über dem Ellipsoid</translation>
    </message>
    <message>
        <source>its height above sea level is {0} m above the ellipsoid (EGM96, good to about 1 m)</source>
        <translation>seine Höhe über dem Meeresspiegel ist {0} m über dem Ellipsoid (EGM96, auf etwa 1 m genau)</translation>
    </message>
    <message>
        <source>the file&apos;s zero point is at the origin you named</source>
        <translation>der Nullpunkt der Datei liegt am genannten Ort</translation>
    </message>
    <message>
        <source>the file&apos;s coordinates lie up to {0} km from zero, so the origin you named is taken as the middle of the building&apos;s footprint, on the ground; if they are projected coordinates, --crs converts them exactly (grid north is not true north)</source>
        <translation>die Koordinaten der Datei liegen bis zu {0} km von null, daher gilt der genannte Ort als Mitte des Grundrisses am Boden; sind es projizierte Koordinaten, rechnet --crs sie genau um (Gitternord ist nicht geografisch Nord)</translation>
    </message>
    <message>
        <source>there is no place for home inside the airspace that is at least {0} m from every wall; widen it with --airspace-margin, or name a place with --home E,N,U</source>
        <translation>im Luftraum ist kein Platz für den Start, der mindestens {0} m von jeder Wand liegt; ihn mit --airspace-margin erweitern oder mit --home E,N,U einen Ort nennen</translation>
    </message>
    <message>
        <source>--airspace-margin, --floor and --ceiling leave no airspace: {0}</source>
        <translation>--airspace-margin, --floor und --ceiling lassen keinen Luftraum: {0}</translation>
    </message>
    <message>
        <source>airspace: {0} m around the building, from {1} to {2} m (--airspace-margin, --floor, --ceiling); no-fly zones and obstacles on site are yours to add</source>
        <translation>Luftraum: {0} m um das Gebäude, von {1} bis {2} m (--airspace-margin, --floor, --ceiling); Flugverbotszonen und Hindernisse vor Ort von Hand ergänzen</translation>
    </message>
    <message>
        <source>home: {0:m}, {1:m}, {2} m, on the ground in front of the largest facade, {3} m from the nearest wall (--home)</source>
        <translation>Startplatz: {0:m}, {1:m}, {2} m, am Boden vor der größten Fassade, {3} m von der nächsten Wand (--home)</translation>
    </message>
    <message>
        <source>home: {0:m}, {1:m}, {2} m, on the ground beside the building, {3} m from the nearest wall (--home)</source>
        <translation>Startplatz: {0:m}, {1:m}, {2} m, am Boden neben dem Gebäude, {3} m von der nächsten Wand (--home)</translation>
    </message>
    <message>
        <source>no place inside the airspace is {0} m from every wall, so home is tight: choose one with --home, or widen --airspace-margin</source>
        <translation>kein Ort im Luftraum liegt {0} m von jeder Wand, der Startplatz ist also eng: einen mit --home wählen oder --airspace-margin erweitern</translation>
    </message>
    <message>
        <source>this mesh cannot be read (its vertices do not have three coordinates each)</source>
        <translation>dieses Netz lässt sich nicht lesen (seine Ecken haben nicht je drei Koordinaten)</translation>
    </message>
    <message>
        <source>a triangle without one of its corners</source>
        <translation>ein Dreieck, dem eine Ecke fehlt</translation>
    </message>
    <message>
        <source>the mesh has no triangles that are whole (a point cloud cannot serve as a building)</source>
        <translation>das Netz hat kein heiles Dreieck (eine Punktwolke kann kein Gebäude sein)</translation>
    </message>
    <message>
        <source>line {0}</source>
        <translation>Zeile {0}</translation>
    </message>
    <message>
        <source>facet {0}</source>
        <translation>Facette {0}</translation>
    </message>
    <message>
        <source>this PLY file cannot be read: it is cut off, or its header announces something else than what is there; copy or export it again</source>
        <translation>diese PLY-Datei lässt sich nicht lesen: sie ist abgeschnitten, oder ihr Kopf kündigt etwas anderes an, als da ist; erneut kopieren oder exportieren</translation>
    </message>
    <message>
        <source>mesh &apos;{0}&apos;</source>
        <translation>Netz &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>node &apos;{0}&apos;</source>
        <translation>Knoten &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>the file is cut off: it announces {0} triangles, and {1} are there; copy or export it again</source>
        <translation>die Datei ist abgeschnitten: sie kündigt {0} Dreiecke an, und {1} sind da; erneut kopieren oder exportieren</translation>
    </message>
    <message>
        <source>the file is cut off: it announces {0} rows, and {1} are there; copy or export it again</source>
        <translation>die Datei ist abgeschnitten: sie kündigt {0} Zeilen an, und {1} sind da; erneut kopieren oder exportieren</translation>
    </message>
    <message>
        <source>checking</source>
        <translation>Prüfung</translation>
    </message>
    <message>
        <source>compiling for this computer, once</source>
        <translation>wird einmalig für diesen Rechner übersetzt</translation>
    </message>
    <message>
        <source>comparing plans</source>
        <translation>Pläne werden verglichen</translation>
    </message>
    <message>
        <source>finding what stands in the way</source>
        <translation>Suche nach dem, was im Weg steht</translation>
    </message>
    <message>
        <source>looking for ways to viewpoints</source>
        <translation>Suche nach Wegen zu Aufnahmepunkten</translation>
    </message>
    <message>
        <source>trying viewpoints</source>
        <translation>Aufnahmepunkte werden probiert</translation>
    </message>
    <message>
        <source>bounding the optimum</source>
        <translation>Schranke für das Optimum</translation>
    </message>
    <message>
        <source>choosing views</source>
        <translation>Aufnahmen werden gewählt</translation>
    </message>
    <message>
        <source>saving views</source>
        <translation>Aufnahmen werden eingespart</translation>
    </message>
    <message>
        <source>spending spare views</source>
        <translation>übrige Aufnahmen werden verteilt</translation>
    </message>
    <message>
        <source>improving views</source>
        <translation>Aufnahmen werden verbessert</translation>
    </message>
    <message>
        <source>laying the grid</source>
        <translation>Raster wird gelegt</translation>
    </message>
    <message>
        <source>laying the rings</source>
        <translation>Ringe werden gelegt</translation>
    </message>
    <message>
        <source>refining poses</source>
        <translation>Aufnahmen werden nachgestellt</translation>
    </message>
    <message>
        <source>reading the site</source>
        <translation>Standort wird gelesen</translation>
    </message>
    <message>
        <source>finding ways around</source>
        <translation>Umwege werden gesucht</translation>
    </message>
    <message>
        <source>looking for viewpoints</source>
        <translation>Aufnahmepunkte werden gesucht</translation>
    </message>
    <message>
        <source>proving what cannot be seen</source>
        <translation>Beweis, was nicht zu sehen ist</translation>
    </message>
    <message>
        <source>drawing legs</source>
        <translation>Strecken werden gezogen</translation>
    </message>
    <message>
        <source>checking legs</source>
        <translation>Strecken werden geprüft</translation>
    </message>
    <message>
        <source>lower bound</source>
        <translation>untere Schranke</translation>
    </message>
    <message>
        <source>orienteering</source>
        <translation>Auswahl für die Akkus</translation>
    </message>
    <message>
        <source>fewer sorties</source>
        <translation>weniger Einsätze</translation>
    </message>
    <message>
        <source>sorties</source>
        <translation>Einsätze</translation>
    </message>
    <message>
        <source>tour</source>
        <translation>Rundweg</translation>
    </message>
    <message>
        <source>neighbours</source>
        <translation>Nachbarn</translation>
    </message>
    <message>
        <source>surfaces</source>
        <translation>Flächen</translation>
    </message>
    <message>
        <source>reading buildings</source>
        <translation>Gebäude werden gelesen</translation>
    </message>
    <message>
        <source>building geometry</source>
        <translation>Geometrie wird gebildet</translation>
    </message>
    <message>
        <source>grouping facades</source>
        <translation>Fassaden werden gebildet</translation>
    </message>
    <message>
        <source>reading the mesh</source>
        <translation>Netz wird gelesen</translation>
    </message>
    <message>
        <source>fitting panels</source>
        <translation>Scheiben werden eingepasst</translation>
    </message>
    <message>
        <source>looking outdoors</source>
        <translation>Blick ins Freie</translation>
    </message>
    <message>
        <source>reading the mission</source>
        <translation>Mission wird gelesen</translation>
    </message>
    <message>
        <source>measuring the plan</source>
        <translation>Plan wird vermessen</translation>
    </message>
    <message>
        <source>measuring</source>
        <translation>Messung</translation>
    </message>
    <message>
        <source>checking the site</source>
        <translation>Standort wird geprüft</translation>
    </message>
    <message>
        <source>starting</source>
        <translation>wird gestartet</translation>
    </message>
    <message>
        <source>no flight through missing sections was found that fits {0}&apos;s waypoint limit and the {1} s that the battery allows; change the battery</source>
        <translation>kein Flug durch fehlende Sektoren gefunden, der zur Wegpunktgrenze von {0} und den {1} s passt, die der Akku erlaubt; Akku wechseln</translation>
    </message>
    <message>
        <source>shortening the flight</source>
        <translation>Flug wird verkürzt</translation>
    </message>
    <message>
        <source>the battery is at {0}; a reserve of {1} and {2} s for take-off and landing leave nothing to fly on; change the battery</source>
        <translation>der Akku steht bei {0}; eine Reserve von {1} und {2} s für Start und Landung lassen nichts zum Fliegen; Akku wechseln</translation>
    </message>
    <message>
        <source>none of the {0} missing sections can be seen from any allowed place that was found on the site as it is now; check its no-fly volumes and obstacles, or lower the minimum distance</source>
        <translation>keiner der {0} fehlenden Sektoren ist von einem erlaubten Ort aus zu sehen, der am Standort, wie er jetzt ist, gefunden wurde; Flugverbotszonen und Hindernisse prüfen oder den Mindestabstand verkleinern</translation>
    </message>
    <message>
        <source> of a battery at {0}</source>
        <translation> eines Akkus bei {0}</translation>
    </message>
    <message>
        <source>{0} of the {1} missing sections can be seen, but none within the {2} s{3} that are left above the reserve; move home closer</source>
        <translation>{0} der {1} fehlenden Sektoren sind zu sehen, aber keiner innerhalb der {2} s{3}, die über der Reserve bleiben; den Startplatz näher legen</translation>
    </message>
    <message>
        <source>{0} of the {1} missing sections can be seen, but none within the {2} s{3} that are left above the reserve; change the battery</source>
        <translation>{0} der {1} fehlenden Sektoren sind zu sehen, aber keiner innerhalb der {2} s{3}, die über der Reserve bleiben; Akku wechseln</translation>
    </message>
    <message>
        <source>comparing the flight</source>
        <translation>Flug wird verglichen</translation>
    </message>
    <message>
        <source>the link is closed</source>
        <translation>die Verbindung ist geschlossen</translation>
    </message>
    <message>
        <source>the other end closed the link</source>
        <translation>die Gegenseite hat die Verbindung geschlossen</translation>
    </message>
    <message>
        <source>the UDP link broke: {0}</source>
        <translation>die UDP-Verbindung ist abgebrochen: {0}</translation>
    </message>
    <message>
        <source>the TCP link to {0} broke: {1}</source>
        <translation>die TCP-Verbindung zu {0} ist abgebrochen: {1}</translation>
    </message>
    <message>
        <source>{0} closed the TCP link</source>
        <translation>{0} hat die TCP-Verbindung geschlossen</translation>
    </message>
    <message>
        <source>serial links need the package pyserial; install it, or use a UDP or TCP link</source>
        <translation>serielle Verbindungen brauchen das Paket pyserial; es installieren oder eine UDP- oder TCP-Verbindung benutzen</translation>
    </message>
    <message>
        <source>the serial line {0} cannot be opened: {1}</source>
        <translation>die serielle Leitung {0} lässt sich nicht öffnen: {1}</translation>
    </message>
    <message>
        <source>the serial line {0} broke: {1}</source>
        <translation>die serielle Leitung {0} ist abgebrochen: {1}</translation>
    </message>
    <message>
        <source>link &apos;{0}&apos;: expected serial:DEVICE:BAUD, such as serial:/dev/ttyUSB0:57600</source>
        <translation>Verbindung &apos;{0}&apos;: erwartet serial:GERÄT:BAUD, etwa serial:/dev/ttyUSB0:57600</translation>
    </message>
    <message>
        <source>link &apos;{0}&apos;: expected KIND:HOST:PORT, such as tcp:127.0.0.1:5760; kinds are {1}</source>
        <translation>Verbindung &apos;{0}&apos;: erwartet ART:RECHNER:PORT, etwa tcp:127.0.0.1:5760; Arten sind {1}</translation>
    </message>
    <message>
        <source>no answer within {0} s; is the address right?</source>
        <translation>keine Antwort in {0} s; stimmt die Adresse?</translation>
    </message>
    <message>
        <source>{0} cannot be opened: {1}; is the address right?</source>
        <translation>{0} lässt sich nicht öffnen: {1}; stimmt die Adresse?</translation>
    </message>
    <message>
        <source>{0} cannot be opened: another program has this port; end it, or take another</source>
        <translation>{0} kann nicht geöffnet werden: Ein anderes Programm hat diesen Port; es beenden oder einen anderen nehmen</translation>
    </message>
    <message>
        <source>reading back</source>
        <translation>wird zurückgelesen</translation>
    </message>
    <message>
        <source>{0} items were sent, {1} are on the vehicle</source>
        <translation>{0} Einträge wurden gesendet, {1} sind auf dem Fluggerät</translation>
    </message>
    <message>
        <source>item {0}, {1}: sent {2}, on the vehicle {3}</source>
        <translation>Eintrag {0}, {1}: gesendet {2}, auf dem Fluggerät {3}</translation>
    </message>
    <message>
        <source>what is on the vehicle now could not be read: do not fly before it was</source>
        <translation>was jetzt auf dem Fluggerät ist, ließ sich nicht lesen: vorher nicht fliegen</translation>
    </message>
    <message>
        <source>nothing is on the vehicle now</source>
        <translation>auf dem Fluggerät ist jetzt nichts</translation>
    </message>
    <message>
        <source>; and {0} more</source>
        <translation>; und {0} weitere</translation>
    </message>
    <message>
        <source>{0} items are on the vehicle, and not those that were sent ({1})</source>
        <translation>{0} Einträge sind auf dem Fluggerät, und nicht die gesendeten ({1})</translation>
    </message>
    <message>
        <source>the list could not be cleared</source>
        <translation>die Liste ließ sich nicht löschen</translation>
    </message>
    <message>
        <source> at item {0}</source>
        <translation> bei Eintrag {0}</translation>
    </message>
    <message>
        <source>the vehicle refused the upload{0} ({1})</source>
        <translation>das Fluggerät lehnte das Hochladen ab{0} ({1})</translation>
    </message>
    <message>
        <source>the vehicle accepted every item</source>
        <translation>das Fluggerät nahm jeden Eintrag an</translation>
    </message>
    <message>
        <source>every item was sent, but the vehicle did not confirm them</source>
        <translation>jeder Eintrag wurde gesendet, aber das Fluggerät bestätigte sie nicht</translation>
    </message>
    <message>
        <source>the vehicle stopped answering{0}</source>
        <translation>das Fluggerät antwortete nicht mehr{0}</translation>
    </message>
    <message>
        <source>the upload did not get on{0}</source>
        <translation>das Hochladen kam nicht voran{0}</translation>
    </message>
    <message>
        <source>the vehicle did not keep to the items{0}</source>
        <translation>das Fluggerät hielt sich nicht an die Einträge{0}</translation>
    </message>
    <message>
        <source>sortie {0} is complete: all {1} views have a photo, so there is nothing to resume</source>
        <translation>Einsatz {0} ist vollständig: Alle {1} Aufnahmen haben ein Foto, es gibt nichts fortzusetzen</translation>
    </message>
    <message>
        <source>the rest of sortie {0} cannot be flown as it was planned{1}: {2}; plan a top-up instead, which finds its own views and ways</source>
        <translation>der Rest von Einsatz {0} lässt sich nicht wie geplant fliegen{1}: {2}; stattdessen einen Ergänzungsflug planen, der eigene Aufnahmen und Wege findet</translation>
    </message>
    <message>
        <source>the sortie cannot be resumed on the site as it is now: {0}</source>
        <translation>der Einsatz lässt sich am Standort, wie er jetzt ist, nicht fortsetzen: {0}</translation>
    </message>
    <message>
        <source>there is no effect &apos;{0}&apos; of the flight; known are: {1}</source>
        <translation>es gibt keinen Effekt &apos;{0}&apos; des Flugs; bekannt sind: {1}</translation>
    </message>
    <message>
        <source>barometer drift</source>
        <translation>Barometerdrift</translation>
    </message>
    <message>
        <source>m at the shutter</source>
        <translation>m bei der Auslösung</translation>
    </message>
    <message>
        <source>the height comes from the GNSS receiver</source>
        <translation>die Höhe kommt vom GNSS-Empfänger</translation>
    </message>
    <message>
        <source>the weather drifts by {0} hPa an hour over a flight of {1} s</source>
        <translation>das Wetter driftet um {0} hPa je Stunde über einen Flug von {1} s</translation>
    </message>
    <message>
        <source>battery sag</source>
        <translation>Akkueinbruch</translation>
    </message>
    <message>
        <source>of the battery</source>
        <translation>des Akkus</translation>
    </message>
    <message>
        <source>{0} of the flight is hovered in {1} m/s of wind: {2} of the power for which the endurance is stated</source>
        <translation>{0} des Flugs wird bei {1} m/s Wind geschwebt: {2} der Leistung, für die die Flugdauer angegeben ist</translation>
    </message>
    <message>
        <source>gimbal lag</source>
        <translation>Gimbalverzug</translation>
    </message>
    <message>
        <source>deg at the shutter</source>
        <translation>Grad bei der Auslösung</translation>
    </message>
    <message>
        <source>there are no views</source>
        <translation>es gibt keine Aufnahmen</translation>
    </message>
    <message>
        <source>turns of up to {0} deg have {1} s to settle</source>
        <translation>Drehungen bis {0} Grad haben {1} s zum Beruhigen</translation>
    </message>
    <message>
        <source>GNSS noise</source>
        <translation>GNSS-Rauschen</translation>
    </message>
    <message>
        <source>an RTK fix</source>
        <translation>RTK-Fix</translation>
    </message>
    <message>
        <source>RTK without fixed ambiguities</source>
        <translation>RTK ohne fixierte Mehrdeutigkeiten</translation>
    </message>
    <message>
        <source>no RTK</source>
        <translation>kein RTK</translation>
    </message>
    <message>
        <source>{0} m horizontally</source>
        <translation>{0} m waagerecht</translation>
    </message>
    <message>
        <source>link loss</source>
        <translation>Verbindungsverlust</translation>
    </message>
    <message>
        <source>of the messages</source>
        <translation>der Nachrichten</translation>
    </message>
    <message>
        <source>{0} of the messages and {1} s are said to be lost</source>
        <translation>{0} der Nachrichten und {1} s sollen verloren gehen</translation>
    </message>
    <message>
        <source>no loss is said to be expected</source>
        <translation>kein Verlust angegeben</translation>
    </message>
    <message>
        <source>at the views {0} of the sky are mirrored in glass and {1} hidden, carrier phase counts</source>
        <translation>an den Aufnahmen spiegeln sich {0} des Himmels im Glas und {1} sind verdeckt, die Trägerphase zählt</translation>
    </message>
    <message>
        <source>at the views {0} of the sky are mirrored in glass and {1} hidden, code counts</source>
        <translation>an den Aufnahmen spiegeln sich {0} des Himmels im Glas und {1} sind verdeckt, der Code zählt</translation>
    </message>
    <message>
        <source>photo latency and blur</source>
        <translation>Auslöseverzug und Unschärfe</translation>
    </message>
    <message>
        <source>px of blur</source>
        <translation>px Unschärfe</translation>
    </message>
    <message>
        <source>photos are taken at rest, where gusts leave {0} m/s; the shutter is open for {1} ms, a pixel is {2} mm on the glass</source>
        <translation>Fotos entstehen in Ruhe, wo Böen {0} m/s lassen; der Verschluss ist {1} ms offen, ein Pixel misst {2} mm auf dem Glas</translation>
    </message>
    <message>
        <source>wind of {0} m/s carries the aircraft away, which leans {1} deg at most and so flies {2} m/s through the air; wait for less wind</source>
        <translation>Wind von {0} m/s trägt das Fluggerät davon, das sich höchstens {1} Grad neigt und so mit {2} m/s durch die Luft fliegt; auf weniger Wind warten</translation>
    </message>
    <message>
        <source>no wind is expected</source>
        <translation>kein Wind erwartet</translation>
    </message>
    <message>
        <source>wind of {0} m/s with gusts of {1} m/s (1 sigma) at {2} m</source>
        <translation>Wind von {0} m/s mit Böen von {1} m/s (1 Sigma) in {2} m Höhe</translation>
    </message>
    <message>
        <source>no answer</source>
        <translation>keine Antwort</translation>
    </message>
    <message>
        <source>not now</source>
        <translation>jetzt nicht</translation>
    </message>
    <message>
        <source>not supported</source>
        <translation>nicht unterstützt</translation>
    </message>
    <message>
        <source>only as COMMAND_LONG</source>
        <translation>nur als COMMAND_LONG</translation>
    </message>
    <message>
        <source>only as COMMAND_INT</source>
        <translation>nur als COMMAND_INT</translation>
    </message>
    <message>
        <source>frame not supported</source>
        <translation>Bezugssystem nicht unterstützt</translation>
    </message>
    <message>
        <source>result {0}</source>
        <translation>Ergebnis {0}</translation>
    </message>
    <message>
        <source>the vehicle refused {0} ({1})</source>
        <translation>das Fluggerät verweigert: {0} ({1})</translation>
    </message>
    <message>
        <source>the vehicle did not answer to {0}</source>
        <translation>das Fluggerät antwortete nicht auf: {0}</translation>
    </message>
    <message>
        <source>preparing the vehicle</source>
        <translation>Fluggerät wird vorbereitet</translation>
    </message>
    <message>
        <source>checking before take-off</source>
        <translation>Prüfung vor dem Start</translation>
    </message>
    <message>
        <source>ready for take-off</source>
        <translation>startbereit</translation>
    </message>
    <message>
        <source>resuming the mission</source>
        <translation>Mission fortsetzen</translation>
    </message>
    <message>
        <source>returning home</source>
        <translation>Heimkehr</translation>
    </message>
    <message>
        <source>landing here</source>
        <translation>hier landen</translation>
    </message>
    <message>
        <source>the vehicle is heard again</source>
        <translation>das Fluggerät ist wieder zu hören</translation>
    </message>
    <message>
        <source>no heartbeat; the aircraft goes on by itself</source>
        <translation>kein Lebenszeichen; das Fluggerät macht selbst weiter</translation>
    </message>
    <message>
        <source>mode {0}.{1}</source>
        <translation>Modus {0}.{1}</translation>
    </message>
    <message>
        <source>mode {0}</source>
        <translation>Modus {0}</translation>
    </message>
    <message>
        <source>pre-arm checks</source>
        <translation>Prüfungen vor dem Scharfschalten</translation>
    </message>
    <message>
        <source>no autopilot was heard yet</source>
        <translation>noch kein Autopilot gehört</translation>
    </message>
    <message>
        <source>no heartbeat for {0} s</source>
        <translation>kein Lebenszeichen seit {0} s</translation>
    </message>
    <message>
        <source>{0} answers</source>
        <translation>{0} antwortet</translation>
    </message>
    <message>
        <source>the autopilot does not know where it is yet</source>
        <translation>der Autopilot weiß noch nicht, wo er ist</translation>
    </message>
    <message>
        <source>the autopilot has {0}</source>
        <translation>dem Autopiloten fehlt: {0}</translation>
    </message>
    <message>
        <source>the autopilot sends no position</source>
        <translation>der Autopilot sendet keine Position</translation>
    </message>
    <message>
        <source>the autopilot knows where it is</source>
        <translation>der Autopilot weiß, wo er ist</translation>
    </message>
    <message>
        <source>the GNSS receiver is silent</source>
        <translation>der GNSS-Empfänger schweigt</translation>
    </message>
    <message>
        <source>fix: {0}, {1} satellites</source>
        <translation>Fix: {0}, {1} Satelliten</translation>
    </message>
    <message>
        <source>; {0} is needed</source>
        <translation>; {0} ist nötig</translation>
    </message>
    <message>
        <source>where the aircraft stands is not known yet</source>
        <translation>wo das Fluggerät steht, ist noch nicht bekannt</translation>
    </message>
    <message>
        <source>the aircraft stands {0} m from the planned home, outside the airspace; put it at {1}</source>
        <translation>das Fluggerät steht {0} m vom geplanten Startplatz, außerhalb des Luftraums; auf {1} stellen</translation>
    </message>
    <message>
        <source>the aircraft stands {0} m from the planned home; put it at {1}, or plan from here</source>
        <translation>das Fluggerät steht {0} m vom geplanten Startplatz; auf {1} stellen oder von hier aus planen</translation>
    </message>
    <message>
        <source>{0} m from the planned home</source>
        <translation>{0} m vom geplanten Startplatz</translation>
    </message>
    <message>
        <source>down to {0} m above the ground</source>
        <translation>bis {0} m über dem Boden</translation>
    </message>
    <message>
        <source>{0}, {1} min below {2} m</source>
        <translation>{0}, {1} min unter {2} m</translation>
    </message>
    <message>
        <source>{0}, under the usual {1} m: look for people, cars and cables on the whole way</source>
        <translation>{0}, unter den üblichen {1} m: auf dem ganzen Weg auf Menschen, Autos und Leitungen achten</translation>
    </message>
    <message>
        <source>the battery&apos;s charge is not known</source>
        <translation>die Ladung des Akkus ist nicht bekannt</translation>
    </message>
    <message>
        <source>the battery holds {0}; the sortie and the reserve take {1}: {2}</source>
        <translation>der Akku hat {0}; Flug und Reserve brauchen {1}: {2}</translation>
    </message>
    <message>
        <source> ({0} flies it in {1} min, the plan reckons with {2} min)</source>
        <translation> ({0} fliegt ihn in {1} min, der Plan rechnet mit {2} min)</translation>
    </message>
    <message>
        <source>put in a full one</source>
        <translation>einen vollen einlegen</translation>
    </message>
    <message>
        <source>none holds that much: plan it again, in shorter sorties</source>
        <translation>so viel hat keiner: in kürzeren Einsätzen neu planen</translation>
    </message>
    <message>
        <source>{0}; the sortie and the reserve take {1}</source>
        <translation>{0}; Flug und Reserve brauchen {1}</translation>
    </message>
    <message>
        <source>the wind blows with {0} m/s, more than the {1} m/s of {2}; wait for less</source>
        <translation>der Wind weht mit {0} m/s, mehr als die {1} m/s von {2}; auf weniger warten</translation>
    </message>
    <message>
        <source>flight (&apos;{0}&apos;), plan (&apos;{1}&apos;) and site (&apos;{2}&apos;) do not have the same name and origin; name the plan and the site file that this flight was flown with</source>
        <translation>Flug (&apos;{0}&apos;), Plan (&apos;{1}&apos;) und Standort (&apos;{2}&apos;) haben nicht denselben Namen und Ursprung; den Plan und die Standortdatei nennen, mit denen geflogen wurde</translation>
    </message>
    <message>
        <source>{0} of {1} sections are missing, too few for a flight unasked; {2}</source>
        <translation>es fehlen {0} von {1} Sektoren, zu wenige für einen Flug ohne Rückfrage; {2}</translation>
    </message>
    <message>
        <source>none of them can be shown</source>
        <translation>keiner davon lässt sich zeigen</translation>
    </message>
    <message>
        <source>showing {0} of them takes {1} min in the air (views: {2}, batteries: {3})</source>
        <translation>{0} davon zu zeigen dauert {1} min in der Luft (Aufnahmen: {2}, Akkus: {3})</translation>
    </message>
    <message>
        <source>the vehicle signs what it sends, and may not obey a link that is not signed; disconnect, and connect signed with its key</source>
        <translation>Das Fluggerät signiert, was es sendet, und gehorcht einer unsignierten Verbindung womöglich nicht; trennen und mit seinem Schlüssel signiert verbinden</translation>
    </message>
    <message>
        <source>the vehicle was given the key and does not sign with it; it may not know signing</source>
        <translation>Das Fluggerät hat den Schlüssel erhalten und signiert nicht damit; womöglich kennt es keine Signatur</translation>
    </message>
    <message>
        <source>no autopilot is heard within {0} s; is it switched on, and does it use this key?</source>
        <translation>Kein Autopilot ist innerhalb von {0} s zu hören; ist er eingeschaltet, und benutzt er diesen Schlüssel?</translation>
    </message>
    <message>
        <source>expected a passphrase of {0} characters or more, got {1}</source>
        <translation>erwartet wurde eine Passphrase von mindestens {0} Zeichen, es sind {1}</translation>
    </message>
    <message>
        <source>there is no signing key on this computer; set one (&apos;signing set&apos;, or Key in the Fly tab)</source>
        <translation>auf diesem Rechner ist kein Schlüssel für die Signatur; einen setzen (&apos;signing set&apos; oder Schlüssel im Reiter Fliegen)</translation>
    </message>
    <message>
        <source>the vehicle signs with another key than this computer&apos;s; set the passphrase that it was given, or give it this computer&apos;s key over a cable</source>
        <translation>Das Fluggerät signiert mit einem anderen Schlüssel als dem dieses Rechners; die Passphrase setzen, die es erhalten hat, oder ihm den Schlüssel dieses Rechners über ein Kabel geben</translation>
    </message>
    <message>
        <source>the vehicle does not sign what it sends; give it this computer&apos;s key over a cable, or connect without signing</source>
        <translation>Das Fluggerät signiert nicht, was es sendet; ihm den Schlüssel dieses Rechners über ein Kabel geben oder unsigniert verbinden</translation>
    </message>
    <message>
        <source>{0} does not hold a time stamp for signing ({1}); delete it</source>
        <translation>{0} enthält keinen Zeitstempel für die Signatur ({1}); löschen</translation>
    </message>
    <message>
        <source>others may read the signing key {0} (mode {1}, expected {2}); give the vehicle a new key, or run: chmod 600 &apos;{3}&apos;</source>
        <translation>andere dürfen den Schlüssel für die Signatur {0} lesen (Rechte {1}, erwartet {2}); dem Fluggerät einen neuen geben, oder ausführen: chmod 600 &apos;{3}&apos;</translation>
    </message>
    <message>
        <source>the signing key {0} cannot be read: {1}</source>
        <translation>der Schlüssel für die Signatur {0} ist nicht lesbar: {1}</translation>
    </message>
    <message>
        <source>{0} cannot be written: {1}</source>
        <translation>{0} ist nicht schreibbar: {1}</translation>
    </message>
    <message>
        <source>{0} does not hold a signing key of {1} hex digits; set it anew</source>
        <translation>{0} enthält keinen Schlüssel von {1} Hexadezimalziffern; neu setzen</translation>
    </message>
    <message>
        <source>the passphrase for signing is empty; expected the one that the vehicle was given</source>
        <translation>die Passphrase für die Signatur ist leer; erwartet wurde die, die das Fluggerät erhalten hat</translation>
    </message>
    <message>
        <source>it climbs within {0} m of the building or an obstacle before it returns ({1})</source>
        <translation>er steigt vor der Rückkehr bis auf {0} m an das Gebäude oder ein Hindernis heran auf ({1})</translation>
    </message>
    <message>
        <source>an aircraft that returns by itself, {0} m above take-off, crosses a no-fly zone; fly it back by hand</source>
        <translation>ein Fluggerät, das selbst zurückkehrt, {0} m über dem Startplatz, kreuzt eine Flugverbotszone; von Hand zurückfliegen</translation>
    </message>
    <message>
        <source>an aircraft that returns by itself flies {0} m above take-off, {1} m are allowed</source>
        <translation>ein Fluggerät, das selbst zurückkehrt, fliegt {0} m über dem Startplatz, {1} m sind erlaubt</translation>
    </message>
    <message>
        <source>the motors stopped {0} m above take-off: the aircraft fell; look for it, and for the cause</source>
        <translation>die Motoren blieben {0} m über dem Startplatz stehen: Das Fluggerät ist abgestürzt; es suchen, und die Ursache</translation>
    </message>
    <message>
        <source>the record ends {0} m above take-off with the motors running; what came after is not in it: take the autopilot&apos;s own log</source>
        <translation>die Aufzeichnung endet {0} m über dem Startplatz mit laufenden Motoren; was danach kam, steht nicht darin: das Log des Autopiloten nehmen</translation>
    </message>
    <message>
        <source>the battery was empty at the end ({0}): the aircraft could have fallen</source>
        <translation>der Akku war am Ende leer ({0}): Das Fluggerät hätte abstürzen können</translation>
    </message>
    <message>
        <source>{0}, and it breaks the mission off and returns ({1})</source>
        <translation>{0}, und es bricht die Mission ab und kehrt zurück ({1})</translation>
    </message>
    <message>
        <source>{0}, and it lands, whatever is below it ({1})</source>
        <translation>{0}, und es landet, was auch immer darunter ist ({1})</translation>
    </message>
    <message>
        <source>{0}, and it hovers until its battery is low ({1})</source>
        <translation>{0}, und es schwebt, bis sein Akku schwach ist ({1})</translation>
    </message>
    <message>
        <source>{0}, and it only keeps its height and drifts with the wind: take over at once ({1})</source>
        <translation>{0}, und es hält nur die Höhe und treibt mit dem Wind: sofort übernehmen ({1})</translation>
    </message>
    <message>
        <source>{0}, and it stops its motors and falls ({1}): set it otherwise</source>
        <translation>{0}, und es schaltet die Motoren ab und stürzt ab ({1}): anders einstellen</translation>
    </message>
    <message>
        <source>{0}, and what the vehicle does is not known ({1})</source>
        <translation>{0}, und was das Fluggerät tut, ist nicht bekannt ({1})</translation>
    </message>
    <message>
        <source>{0} s without the link</source>
        <translation>{0} s ohne Verbindung</translation>
    </message>
    <message>
        <source>what the vehicle does without its remote control is not known: it has no {0}</source>
        <translation>was das Fluggerät ohne seine Fernsteuerung tut, ist nicht bekannt: es hat kein {0}</translation>
    </message>
    <message>
        <source>it takes no remote control (COM_RC_IN_MODE {0}): only this ground station can take over</source>
        <translation>es nimmt keine Fernsteuerung an (COM_RC_IN_MODE {0}): nur diese Bodenstation kann übernehmen</translation>
    </message>
    <message>
        <source>{0} s without the remote control</source>
        <translation>{0} s ohne Fernsteuerung</translation>
    </message>
    <message>
        <source>nothing is done by itself when the battery is low: watch it, and land in time</source>
        <translation>bei schwachem Akku geschieht nichts von selbst: ihn beobachten und rechtzeitig landen</translation>
    </message>
    <message>
        <source>the vehicle breaks the mission off at a charge of {0}, and the sortie ends with {1}: set {2} so that it lasts</source>
        <translation>das Fluggerät bricht die Mission bei einer Ladung von {0} ab, und der Einsatz endet mit {1}: {2} so setzen, dass sie reicht</translation>
    </message>
    <message>
        <source>battery below {0}</source>
        <translation>Akku unter {0}</translation>
    </message>
    <message>
        <source>COM_LOW_BAT_ACT {0}</source>
        <translation>COM_LOW_BAT_ACT {0}</translation>
    </message>
    <message>
        <source>{0} mAh</source>
        <translation>{0} mAh</translation>
    </message>
    <message>
        <source>BATT_FS_{0}_ACT {1}</source>
        <translation>BATT_FS_{0}_ACT {1}</translation>
    </message>
    <message>
        <source>what the vehicle does when it loses its position is not known: it has no {0}</source>
        <translation>was das Fluggerät tut, wenn es seine Position verliert, ist nicht bekannt: es hat kein {0}</translation>
    </message>
    <message>
        <source>FS_EKF_THRESH {0}</source>
        <translation>FS_EKF_THRESH {0}</translation>
    </message>
    <message>
        <source>position lost</source>
        <translation>Position verloren</translation>
    </message>
    <message>
        <source>{0} go by the number {1} on this link: switch one off, or give each a number of its own (SYSID_THISMAV, MAV_SYS_ID)</source>
        <translation>{0} tragen auf dieser Verbindung die Nummer {1}: eines ausschalten, oder jedem eine eigene Nummer geben (SYSID_THISMAV, MAV_SYS_ID)</translation>
    </message>
    <message>
        <source>{0} answers, vehicle {1}; others are on the link, too: {2}</source>
        <translation>{0} antwortet, Fluggerät {1}; weitere sind auf der Verbindung: {2}</translation>
    </message>
    <message>
        <source>the motors stopped {0} m above take-off: the aircraft fell; look for it{1}</source>
        <translation>die Motoren blieben {0} m über dem Startplatz stehen: Das Fluggerät ist abgestürzt; es suchen{1}</translation>
    </message>
    <message>
        <source>two vehicles of different kinds</source>
        <translation>zwei Fluggeräte verschiedener Art</translation>
    </message>
    <message>
        <source>two vehicles whose times since power-up differ</source>
        <translation>zwei Fluggeräte, deren Zeiten seit dem Einschalten verschieden sind</translation>
    </message>
    <message>
        <source>two vehicles at different places</source>
        <translation>zwei Fluggeräte an verschiedenen Orten</translation>
    </message>
    <message>
        <source>{0} go by one number on this link: nothing shown here can be relied on; fly it by hand</source>
        <translation>{0} tragen auf dieser Verbindung eine Nummer: Auf nichts, was hier steht, ist Verlass; von Hand fliegen</translation>
    </message>
    <message>
        <source>the aircraft sends no position any more: its distance, airspace, no-fly zones and path are not watched; fly it by hand</source>
        <translation>das Fluggerät sendet keine Position mehr: Abstand, Luftraum, Flugverbotszonen und Weg werden nicht überwacht; von Hand fliegen</translation>
    </message>
    <message>
        <source>the autopilot has {0}: its place may be wrong, and so may the warnings of distance, airspace, no-fly zones and path; be ready to fly by hand</source>
        <translation>der Autopilot meldet: {0}; sein Ort kann falsch sein, und damit die Warnungen zu Abstand, Luftraum, Flugverbotszonen und Weg; bereit sein, von Hand zu fliegen</translation>
    </message>
    <message>
        <source>the camera looked {0} degrees off at viewpoint &apos;{1}&apos;, and elsewhere at {2} of the last {3} photos: the gimbal may be stuck; pause, and look</source>
        <translation>die Kamera sah bei Aufnahmepunkt &apos;{1}&apos; um {0} Grad daneben, und bei {2} der letzten {3} Fotos anderswohin: Der Gimbal klemmt vielleicht; anhalten und nachsehen</translation>
    </message>
    <message>
        <source>it climbs there on its way, and no other height mends that; be ready to fly it back by hand</source>
        <translation>es steigt auf seinem Weg dort auf, und keine andere Höhe hilft; bereit sein, es von Hand zurückzufliegen</translation>
    </message>
    <message>
        <source>what the vehicle does when the link is lost is not known: it has no {0}</source>
        <translation>was das Fluggerät bei verlorener Verbindung tut, ist nicht bekannt: es hat kein {0}</translation>
    </message>
    <message>
        <source>how high the vehicle returns is not known; look before it is told to return</source>
        <translation>wie hoch das Fluggerät zurückkehrt, ist nicht bekannt; hinsehen, bevor es zurückgerufen wird</translation>
    </message>
    <message>
        <source>{0} m above take-off, to the nearest of home and the rally points ({1})</source>
        <translation>{0} m über dem Start zum nächsten von Startplatz und Rally-Punkten ({1})</translation>
    </message>
    <message>
        <source>{0} m above take-off, to home</source>
        <translation>{0} m über dem Start zum Startplatz</translation>
    </message>
    <message>
        <source>set {0} so that it returns {1} m above take-off</source>
        <translation>{0} so setzen, dass es {1} m über dem Start zurückkehrt</translation>
    </message>
    <message>
        <source>it returns straight through the building or an obstacle ({0}): {1}</source>
        <translation>es kehrt geradewegs durch das Gebäude oder ein Hindernis zurück ({0}): {1}</translation>
    </message>
    <message>
        <source>it returns {0} m from the building or an obstacle ({1}): {2}</source>
        <translation>es kehrt {0} m neben dem Gebäude oder einem Hindernis zurück ({1}): {2}</translation>
    </message>
    <message>
        <source>it returns across a no-fly zone ({0}); fly it back by hand</source>
        <translation>es kehrt durch einen Flugverbotsraum zurück ({0}); von Hand zurückfliegen</translation>
    </message>
    <message>
        <source>it returns {0}</source>
        <translation>es kehrt zurück: {0}</translation>
    </message>
    <message>
        <source>the geofence is on board, but nothing keeps the aircraft from leaving it ({0})</source>
        <translation>der Geofence ist an Bord, aber nichts hindert das Fluggerät, ihn zu verletzen ({0})</translation>
    </message>
    <message>
        <source>at the geofence it returns ({0})</source>
        <translation>am Geofence kehrt es zurück ({0})</translation>
    </message>
    <message>
        <source>at the geofence it lands ({0})</source>
        <translation>am Geofence landet es ({0})</translation>
    </message>
    <message>
        <source>at the geofence it hovers ({0})</source>
        <translation>am Geofence schwebt es ({0})</translation>
    </message>
    <message>
        <source>at the geofence it stops its motors and falls ({0}): set it otherwise</source>
        <translation>am Geofence hält es die Motoren an und stürzt ab ({0}): anders einstellen</translation>
    </message>
    <message>
        <source>what the vehicle does at the geofence is not known: see {0}</source>
        <translation>was das Fluggerät am Geofence tut, ist nicht bekannt: siehe {0}</translation>
    </message>
    <message>
        <source>the sortie climbs to {0} m above take-off, the vehicle&apos;s fence ends at {1} m: raise {2}</source>
        <translation>der Flug steigt auf {0} m über Start, der Geofence des Fluggeräts endet bei {1} m: {2} erhöhen</translation>
    </message>
    <message>
        <source>the sortie climbs to {0} m below the vehicle&apos;s fence: raise {1}</source>
        <translation>der Flug steigt bis {0} m unter den Geofence des Fluggeräts: {1} erhöhen</translation>
    </message>
    <message>
        <source>the sortie stays {0} m below the vehicle&apos;s fence ({1})</source>
        <translation>der Flug bleibt {0} m unter dem Geofence des Fluggeräts ({1})</translation>
    </message>
    <message>
        <source>the sortie goes {0} m away from home, the vehicle&apos;s fence ends at {1} m: raise {2}</source>
        <translation>der Flug führt {0} m vom Startplatz weg, der Geofence des Fluggeräts endet bei {1} m: {2} erhöhen</translation>
    </message>
    <message>
        <source>the sortie comes within {0} m of the vehicle&apos;s fence: raise {1}</source>
        <translation>der Flug kommt dem Geofence des Fluggeräts auf {0} m nahe: {1} erhöhen</translation>
    </message>
    <message>
        <source>the sortie stays {0} m inside the vehicle&apos;s fence ({1})</source>
        <translation>der Flug bleibt {0} m innerhalb des Geofence des Fluggeräts ({1})</translation>
    </message>
    <message>
        <source>{0} is {1}: the autopilot commands no camera, or no gimbal; set it to {2} and restart the vehicle</source>
        <translation>{0} ist {1}: der Autopilot steuert keine Kamera oder keinen Gimbal an; auf {2} setzen und das Fluggerät neu starten</translation>
    </message>
    <message>
        <source>the vehicle was restarted</source>
        <translation>das Fluggerät wurde neu gestartet</translation>
    </message>
    <message>
        <source>the vehicle was not heard for a while</source>
        <translation>das Fluggerät war eine Weile nicht zu hören</translation>
    </message>
    <message>
        <source>the vehicle says that it holds something else now</source>
        <translation>das Fluggerät sagt, dass es jetzt etwas anderes an Bord hat</translation>
    </message>
    <message>
        <source>another ground station has written to the vehicle</source>
        <translation>eine andere Bodenstation hat auf das Fluggerät geschrieben</translation>
    </message>
    <message>
        <source>it could not be read</source>
        <translation>es konnte nicht gelesen werden</translation>
    </message>
    <message>
        <source>the {0} on board could not be read again ({1})</source>
        <translation>{0}: an Bord, konnte nicht noch einmal gelesen werden ({1})</translation>
    </message>
    <message>
        <source>the vehicle has another {0} now: {1}</source>
        <translation>{0}: Das Fluggerät hat jetzt etwas anderes an Bord: {1}</translation>
    </message>
    <message>
        <source>the {0} on board is the one that was uploaded</source>
        <translation>{0}: an Bord ist, was hochgeladen wurde</translation>
    </message>
    <message>
        <source>what is on board is not known any more: {0}</source>
        <translation>was an Bord ist, ist nicht mehr bekannt: {0}</translation>
    </message>
    <message>
        <source>the {0} was uploaded, but {1}: it is read again</source>
        <translation>{0}: hochgeladen, aber {1}: wird noch einmal gelesen</translation>
    </message>
    <message>
        <source>the {0} on the vehicle is not the one that was uploaded; it was not started: upload it again</source>
        <translation>{0}: Auf dem Fluggerät ist nicht, was hochgeladen wurde; nicht gestartet: noch einmal hochladen</translation>
    </message>
    <message>
        <source>{0}; it was not started</source>
        <translation>{0}; nicht gestartet</translation>
    </message>
    <message>
        <source>what is on the vehicle is not known ({0}); it was not started: wait until it is read</source>
        <translation>was auf dem Fluggerät ist, ist nicht bekannt ({0}); nicht gestartet: warten, bis es gelesen ist</translation>
    </message>
    <message>
        <source>the vehicle has another mission now than the one that was uploaded: pause it, and look what it does</source>
        <translation>das Fluggerät hat jetzt eine andere Mission als die hochgeladene: anhalten und nachsehen, was es tut</translation>
    </message>
    <message>
        <source>through the building or an obstacle</source>
        <translation>durch das Gebäude oder ein Hindernis</translation>
    </message>
    <message>
        <source>{0} m from something</source>
        <translation>{0} m an etwas vorbei</translation>
    </message>
    <message>
        <source>an aircraft that returns by itself would fly {0}: at {1} m above take-off it clears everything, and the airspace ends at {2} m; raise its ceiling, or move home to the side of the building that is flown</source>
        <translation>ein Fluggerät, das selbst zurückkehrt, flöge {0}: Mit {1} m über dem Startplatz kommt es über alles hinweg, und der Luftraum endet bei {2} m; seine Obergrenze anheben, oder den Startplatz auf die Seite des Gebäudes legen, die beflogen wird</translation>
    </message>
    <message>
        <source>an aircraft that returns by itself climbs within {0} m of the building or an obstacle</source>
        <translation>ein Fluggerät, das selbst zurückkehrt, steigt {0} m neben dem Gebäude oder einem Hindernis auf</translation>
    </message>
    <message>
        <source>the return height is above the airspace: expected at most {0} m above take-off, got {1} m; {2} m are right</source>
        <translation>die Rückkehrhöhe liegt über dem Luftraum: erwartet höchstens {0} m über dem Startplatz, angegeben {1} m; {2} m sind richtig</translation>
    </message>
    <message>
        <source>it returns above the airspace, which ends {0} m above take-off ({1}): {2}</source>
        <translation>es kehrt über dem Luftraum zurück, der {0} m über dem Startplatz endet ({1}): {2}</translation>
    </message>
    <message>
        <source>the flight would begin {0} m above take-off, at least {1} m are needed; plan it from where the aircraft stands</source>
        <translation>der Flug begänne {0} m über dem Startplatz, mindestens {1} m sind nötig; von dort planen, wo das Fluggerät steht</translation>
    </message>
    <message>
        <source>{0} (overruled)</source>
        <translation>{0} (übergangen)</translation>
    </message>
    <message>
        <source>how high the aircraft stands is not known yet</source>
        <translation>wie hoch das Fluggerät steht, ist noch nicht bekannt</translation>
    </message>
    <message>
        <source> (its GNSS height is good to {0} m)</source>
        <translation> (seine GNSS-Höhe ist auf {0} m genau)</translation>
    </message>
    <message>
        <source>{0} m above the planned home{1}</source>
        <translation>{0} m über dem geplanten Startplatz{1}</translation>
    </message>
    <message>
        <source>{0} m below the planned home{1}</source>
        <translation>{0} m unter dem geplanten Startplatz{1}</translation>
    </message>
    <message>
        <source>they are as the plan needs them</source>
        <translation>sie sind, wie der Plan sie braucht</translation>
    </message>
    <message>
        <source>; {0} more differ</source>
        <translation>; {0} weitere weichen ab</translation>
    </message>
    <message>
        <source>the vehicle does not know these parameters: {0}</source>
        <translation>diese Parameter kennt das Fluggerät nicht: {0}</translation>
    </message>
    <message>
        <source>the aircraft stands {0} m lower than the planned home{1}, and all of the flight would be: raise it by {2} m, or plan from here</source>
        <translation>das Fluggerät steht {0} m tiefer als der geplante Startplatz{1}, und so läge der ganze Flug: ihn um {2} m anheben, oder von hier planen</translation>
    </message>
    <message>
        <source>the aircraft stands {0} m higher than the planned home{1}, and all of the flight would be: lower it by {2} m, or plan from here</source>
        <translation>das Fluggerät steht {0} m höher als der geplante Startplatz{1}, und so läge der ganze Flug: ihn um {2} m absenken, oder von hier planen</translation>
    </message>
    <message>
        <source>the vehicle&apos;s own home lies {0} m higher than the planned one: set it anew where it stands</source>
        <translation>der eigene Startplatz des Fluggeräts liegt {0} m höher als der geplante: dort neu setzen, wo es steht</translation>
    </message>
    <message>
        <source>the vehicle&apos;s own home lies {0} m lower than the planned one: set it anew where it stands</source>
        <translation>der eigene Startplatz des Fluggeräts liegt {0} m tiefer als der geplante: dort neu setzen, wo es steht</translation>
    </message>
    <message>
        <source>the vehicle counts its heights from {0} m above the planned home; it was not started: set its home anew where it stands</source>
        <translation>das Fluggerät zählt seine Höhen von {0} m über dem geplanten Startplatz; nicht gestartet: seinen Startplatz dort neu setzen, wo es steht</translation>
    </message>
    <message>
        <source>the vehicle counts its heights from {0} m below the planned home; it was not started: set its home anew where it stands</source>
        <translation>das Fluggerät zählt seine Höhen von {0} m unter dem geplanten Startplatz; nicht gestartet: seinen Startplatz dort neu setzen, wo es steht</translation>
    </message>
    <message>
        <source>the vehicle does not say whether it has rally points; look before it returns by itself</source>
        <translation>das Fluggerät sagt nicht, ob es Rally-Punkte hat; hinsehen, bevor es von selbst zurückkehrt</translation>
    </message>
    <message>
        <source>list of rally points</source>
        <translation>Liste der Rally-Punkte</translation>
    </message>
    <message>
        <source>the vehicle had {0} rally points of another flight; they are cleared</source>
        <translation>das Fluggerät hatte {0} Rally-Punkte eines anderen Flugs; sie sind gelöscht</translation>
    </message>
    <message>
        <source>it does not say why</source>
        <translation>er sagt nicht, warum</translation>
    </message>
    <message>
        <source>the autopilot cannot be armed yet ({0})</source>
        <translation>der Autopilot lässt sich noch nicht scharfschalten ({0})</translation>
    </message>
    <message>
        <source>it can be armed, but has trouble with: </source>
        <translation>er lässt sich scharfschalten, hat aber Mühe mit: </translation>
    </message>
    <message>
        <source>not measured on the ground; look up</source>
        <translation>am Boden nicht gemessen; nach oben schauen</translation>
    </message>
    <message>
        <source>the {0} was not uploaded yet</source>
        <translation>noch nicht hochgeladen: {0}</translation>
    </message>
    <message>
        <source>what the vehicle holds is not this {0}: upload it again</source>
        <translation>auf dem Fluggerät ist etwas anderes als diese {0}: noch einmal hochladen</translation>
    </message>
    <message>
        <source>the {0} is on board, read back and equal</source>
        <translation>an Bord, zurückgelesen und gleich: {0}</translation>
    </message>
    <message>
        <source>no ArduPilot or PX4 was heard within {0} s; is the vehicle on, and the address right?</source>
        <translation>weder ArduPilot noch PX4 in {0} s gehört; ist das Fluggerät an und die Adresse richtig?</translation>
    </message>
    <message>
        <source>expected {0}, found {1}; name the other autopilot</source>
        <translation>erwartet {0}, gefunden {1}; den anderen Autopiloten nennen</translation>
    </message>
    <message>
        <source>the vehicle is armed already; land and disarm it first</source>
        <translation>das Fluggerät ist schon scharf; zuerst landen und sichern</translation>
    </message>
    <message>
        <source>sending telemetry</source>
        <translation>Telemetrie senden</translation>
    </message>
    <message>
        <source>the vehicle is heard but does not answer; does the link go both ways?</source>
        <translation>das Fluggerät ist zu hören, antwortet aber nicht; geht die Verbindung in beide Richtungen?</translation>
    </message>
    <message>
        <source>{0}; {1} take effect after a reboot only: restart the vehicle</source>
        <translation>{0}; {1} wirken erst nach einem Neustart: das Fluggerät neu starten</translation>
    </message>
    <message>
        <source>the autopilot restarts, so that {0} take effect</source>
        <translation>der Autopilot startet neu, damit {0} wirken</translation>
    </message>
    <message>
        <source>the vehicle did not come back within {0} s of its reboot</source>
        <translation>das Fluggerät kam in {0} s nach seinem Neustart nicht wieder</translation>
    </message>
    <message>
        <source>the vehicle was not rebooted; {0} take effect then: restart it</source>
        <translation>das Fluggerät wurde nicht neu gestartet; {0} wirken erst dann: neu starten</translation>
    </message>
    <message>
        <source>the {0} is not on the vehicle: {1}</source>
        <translation>nicht auf dem Fluggerät: {0}: {1}</translation>
    </message>
    <message>
        <source>not ready for take-off: </source>
        <translation>nicht startbereit: </translation>
    </message>
    <message>
        <source>not ready for take-off after {0} s: </source>
        <translation>nach {0} s nicht startbereit: </translation>
    </message>
    <message>
        <source>the mode {0}</source>
        <translation>der Modus {0}</translation>
    </message>
    <message>
        <source>starting the mission</source>
        <translation>Mission starten</translation>
    </message>
    <message>
        <source>the vehicle is in mode {0} and not in {1}</source>
        <translation>das Fluggerät ist im Modus {0} und nicht in {1}</translation>
    </message>
    <message>
        <source>the aircraft did not take off{0}</source>
        <translation>das Fluggerät hob nicht ab{0}</translation>
    </message>
    <message>
        <source>the vehicle was not heard for {0} s in flight; what was recorded ends there</source>
        <translation>das Fluggerät war im Flug {0} s nicht zu hören; die Aufzeichnung endet dort</translation>
    </message>
    <message>
        <source>the aircraft is armed for longer than any battery lasts; look at what it does</source>
        <translation>das Fluggerät ist länger scharf, als ein Akku hält; nachsehen, was es tut</translation>
    </message>
    <message>
        <source>its measurements contradict each other</source>
        <translation>Messungen, die zueinander passen</translation>
    </message>
    <message>
        <source>no position yet</source>
        <translation>noch keine Position</translation>
    </message>
    <message>
        <source>no height yet</source>
        <translation>noch keine Höhe</translation>
    </message>
    <message>
        <source>no velocity yet</source>
        <translation>noch keine Geschwindigkeit</translation>
    </message>
    <message>
        <source>this log exists already; name another file</source>
        <translation>dieses Protokoll gibt es schon; eine andere Datei nennen</translation>
    </message>
    <message>
        <source>the telemetry log cannot be made ({0})</source>
        <translation>das Telemetrieprotokoll lässt sich nicht anlegen ({0})</translation>
    </message>
    <message>
        <source>the disk is full</source>
        <translation>der Datenträger ist voll</translation>
    </message>
    <message>
        <source>the telemetry log may lack its end ({0})</source>
        <translation>dem Telemetrieprotokoll fehlt vielleicht das Ende ({0})</translation>
    </message>
    <message>
        <source>the telemetry log cannot be written ({0}); free some space, and it goes on by itself</source>
        <translation>das Telemetrieprotokoll lässt sich nicht schreiben ({0}); Platz schaffen, dann geht es von selbst weiter</translation>
    </message>
    <message>
        <source>no heartbeat for {0} s: what is shown is old; the aircraft goes on by itself</source>
        <translation>kein Lebenszeichen seit {0} s: die Anzeige ist veraltet; das Fluggerät macht selbst weiter</translation>
    </message>
    <message>
        <source>the facade is {0} m away and will be {1} m away where the aircraft can stop</source>
        <translation>die Fassade ist {0} m entfernt und wird {1} m entfernt sein, wo das Fluggerät anhalten kann</translation>
    </message>
    <message>
        <source>the wind is {0} m/s; {1} may fly in up to {2} m/s</source>
        <translation>der Wind hat {0} m/s; {1} darf bis {2} m/s fliegen</translation>
    </message>
    <message>
        <source>the battery holds {0}, less than the reserve of {1}: land</source>
        <translation>der Akku hält {0}, weniger als die Reserve von {1}: landen</translation>
    </message>
    <message>
        <source>the way home would use the reserve: {0} left, {1} needed</source>
        <translation>der Heimweg würde die Reserve brauchen: {0} übrig, {1} nötig</translation>
    </message>
    <message>
        <source>the battery holds {0}; at {1} the aircraft must turn home</source>
        <translation>der Akku hält {0}; bei {1} muss das Fluggerät umkehren</translation>
    </message>
    <message>
        <source>the airspace ends {0} m from where the aircraft can stop</source>
        <translation>der Luftraum endet {0} m von der Stelle, wo das Fluggerät anhalten kann</translation>
    </message>
    <message>
        <source>the aircraft is {0} m outside the airspace</source>
        <translation>das Fluggerät ist {0} m außerhalb des Luftraums</translation>
    </message>
    <message>
        <source>a no-fly zone is {0} m from where the aircraft can stop</source>
        <translation>eine Flugverbotszone ist {0} m von der Stelle, wo das Fluggerät anhalten kann</translation>
    </message>
    <message>
        <source>the GNSS receiver has lost its fix: fly by hand or land</source>
        <translation>der GNSS-Empfänger hat seinen Fix verloren: von Hand fliegen oder landen</translation>
    </message>
    <message>
        <source>RTK is lost</source>
        <translation>RTK ist verloren</translation>
    </message>
    <message>
        <source>no photo came from viewpoint &apos;{0}&apos;; {1} of this sortie are missing</source>
        <translation>von Aufnahmepunkt &apos;{0}&apos; kam kein Foto; {1} dieses Einsatzes fehlen</translation>
    </message>
    <message>
        <source>the aircraft is {0} m beside its planned path</source>
        <translation>das Fluggerät ist {0} m neben seinem geplanten Weg</translation>
    </message>
    <message>
        <source>the plan was made for the site &apos;{0}&apos; as it was then, and this is another site &apos;{1}&apos;; name the site file that it was made for, or plan again</source>
        <translation>der Plan wurde für den Standort &apos;{0}&apos; gemacht, wie er damals war, und dies ist ein anderer Standort &apos;{1}&apos;; dessen Datei nennen oder neu planen</translation>
    </message>
    <message>
        <source>the plan was made for the site &apos;{0}&apos; as it was then, and this is a changed site &apos;{1}&apos;; name the site file that it was made for, or plan again</source>
        <translation>der Plan wurde für den Standort &apos;{0}&apos; gemacht, wie er damals war, und dies ist ein geänderter Standort &apos;{1}&apos;; dessen Datei nennen oder neu planen</translation>
    </message>
    <message>
        <source>nothing can be uploaded now: the vehicle must be heard, on the ground and disarmed</source>
        <translation>jetzt lässt sich nichts hochladen: Das Fluggerät muss zu hören, am Boden und gesichert sein</translation>
    </message>
    <message>
        <source>the pre-flight list is not all well, or nothing was uploaded yet</source>
        <translation>die Liste vor dem Flug ist nicht ganz in Ordnung, oder es wurde noch nichts hochgeladen</translation>
    </message>
    <message>
        <source>the vehicle does not fly its mission, so there is nothing to pause</source>
        <translation>das Fluggerät fliegt seine Mission nicht, es gibt nichts anzuhalten</translation>
    </message>
    <message>
        <source>the vehicle is not in flight, so there is nothing to resume</source>
        <translation>das Fluggerät ist nicht im Flug, es gibt nichts fortzusetzen</translation>
    </message>
    <message>
        <source>no vehicle was heard yet, so none can return</source>
        <translation>noch kein Fluggerät gehört, keines kann heimkehren</translation>
    </message>
    <message>
        <source>no vehicle was heard yet, so none can land</source>
        <translation>noch kein Fluggerät gehört, keines kann landen</translation>
    </message>
    <message>
        <source>there is no link</source>
        <translation>es gibt keine Verbindung</translation>
    </message>
    <message>
        <source>the mission is on board, read back and equal</source>
        <translation>die Mission ist an Bord, zurückgelesen und gleich</translation>
    </message>
    <message>
        <source>the aircraft flies its mission</source>
        <translation>das Fluggerät fliegt seine Mission</translation>
    </message>
    <message>
        <source>the flight could not be watched any longer ({0}: {1}); please report it</source>
        <translation>der Flug ließ sich nicht weiter beobachten ({0}: {1}); bitte melden</translation>
    </message>
    <message>
        <source>disconnected in flight; the aircraft goes on by itself, what was recorded ends there</source>
        <translation>im Flug getrennt; das Fluggerät macht selbst weiter, die Aufzeichnung endet dort</translation>
    </message>
    <message>
        <source>preparing the flight</source>
        <translation>Flug wird vorbereitet</translation>
    </message>
    <message>
        <source>the plan breaks {0} pre-flight rules, such as: {1}; correct it before it is flown</source>
        <translation>der Plan verletzt {0} Regeln vor dem Flug, etwa: {1}; ihn vor dem Flug berichtigen</translation>
    </message>
    <message>
        <source>cannot be seen from any allowed place that was found on the site as it is now</source>
        <translation>sind von keinem erlaubten Ort aus zu sehen, der am Standort, wie er jetzt ist, gefunden wurde</translation>
    </message>
    <message>
        <source>can be seen, but the batteries allowed do not last for them; change the battery</source>
        <translation>sind zu sehen, aber die erlaubten Akkus reichen nicht für sie; Akku wechseln</translation>
    </message>
    <message>
        <source>can only be seen from places closer together than aircraft accept</source>
        <translation>sind nur von Orten zu sehen, die dichter beieinander liegen, als Fluggeräte annehmen</translation>
    </message>
    <message>
        <source>its plan has another checksum</source>
        <translation>sein Plan hat eine andere Prüfsumme</translation>
    </message>
    <message>
        <source>none of its {0} photos was taken near a view of it</source>
        <translation>keines seiner {0} Fotos entstand nahe einer seiner Aufnahmen</translation>
    </message>
    <message>
        <source>this is a flight of another plan: {0}; name the plan file that it was flown with, as it was then</source>
        <translation>dies ist ein Flug eines anderen Plans: {0}; die Plandatei nennen, mit der geflogen wurde, wie sie damals war</translation>
    </message>
    <message>
        <source>the site file has changed since the plan was made; what is missing is planned on the site as it is now</source>
        <translation>die Standortdatei hat sich seit dem Plan geändert; was fehlt, wird am Standort geplant, wie er jetzt ist</translation>
    </message>
    <message>
        <source>{0} photos belong to no view, and nothing says where they look; what they show counts as missing</source>
        <translation>{0} Fotos gehören zu keiner Aufnahme, und nichts sagt, wohin sie blicken; was sie zeigen, gilt als fehlend</translation>
    </message>
    <message>
        <source>{0} of the {1} missing sections (on {2} panels) {3}</source>
        <translation>{0} der {1} fehlenden Sektoren (auf {2} Scheiben) {3}</translation>
    </message>
    <message>
        <source>no sortie of this plan was interrupted: those that were flown are complete; the next one is flown from the plan itself</source>
        <translation>kein Einsatz dieses Plans wurde unterbrochen: Die geflogenen sind vollständig; der nächste wird vom Plan selbst geflogen</translation>
    </message>
    <message>
        <source>sortie: expected 1 to {0}, got {1}</source>
        <translation>Einsatz: erwartet 1 bis {0}, gefunden {1}</translation>
    </message>
    <message>
        <source>the rest of sortie {0} takes {1} s, but a battery at {2} allows {3} s above the reserve; change the battery, or plan a top-up, which fits it</source>
        <translation>der Rest von Einsatz {0} dauert {1} s, aber ein Akku bei {2} erlaubt {3} s über der Reserve; Akku wechseln oder einen Ergänzungsflug planen, der passt</translation>
    </message>
    <message>
        <source>{0} views were photographed, but the camera&apos;s reports were lost on the radio; what they show counts as missing. The autopilot&apos;s log (.BIN, .ulg) tells of them: name it instead of the flight file</source>
        <translation>{0} Aufnahmen wurden gemacht, aber die Meldungen der Kamera gingen über Funk verloren; was sie zeigen, gilt als fehlend. Das Protokoll des Autopiloten (.BIN, .ulg) weiß davon: es statt der Flugdatei nennen</translation>
    </message>
    <message>
        <source>there is no record of any flight</source>
        <translation>es gibt keine Aufzeichnung eines Fluges</translation>
    </message>
    <message>
        <source>this flight is none of the plan&apos;s sorties: no photo and no view of them is near its track</source>
        <translation>dieser Flug ist keiner der Einsätze des Plans: Kein Foto und keine Aufnahme davon liegt nahe an seiner Spur</translation>
    </message>
    <message>
        <source>recorded as sortie {0}, but it flew sortie {1}; it counts as what it flew</source>
        <translation>als Einsatz {0} aufgezeichnet, geflogen wurde aber Einsatz {1}; er zählt als das, was geflogen wurde</translation>
    </message>
    <message>
        <source>record {0}</source>
        <translation>Aufzeichnung {0}</translation>
    </message>
    <message>
        <source>look through the photos before planning a top-up flight</source>
        <translation>die Fotos durchsehen, bevor ein Ergänzungsflug geplant wird</translation>
    </message>
    <message>
        <source>plan a top-up flight for them</source>
        <translation>für sie einen Ergänzungsflug planen</translation>
    </message>
    <message>
        <source>{0} of {1} views have no photo that is known of: {2}; {3}</source>
        <translation>{0} von {1} Aufnahmen haben kein bekanntes Foto: {2}; {3}</translation>
    </message>
    <message>
        <source>in sorties that were not flown</source>
        <translation>in Einsätzen, die nicht geflogen wurden</translation>
    </message>
    <message>
        <source>not reached</source>
        <translation>nicht erreicht</translation>
    </message>
    <message>
        <source>reached, but the camera did not answer</source>
        <translation>erreicht, aber die Kamera antwortete nicht</translation>
    </message>
    <message>
        <source>photographed, but the camera&apos;s report was lost</source>
        <translation>aufgenommen, aber die Meldung der Kamera ging verloren</translation>
    </message>
    <message>
        <source>photographed from too far away</source>
        <translation>aus zu großer Entfernung aufgenommen</translation>
    </message>
    <message>
        <source>where the photo looks elsewhere</source>
        <translation>mit einem Foto, das woandershin blickt</translation>
    </message>
    <message>
        <source>not reached before the flight ended</source>
        <translation>nicht erreicht, ehe der Flug endete</translation>
    </message>
    <message>
        <source>after the end of the record in the air</source>
        <translation>nach dem Ende der Aufzeichnung in der Luft</translation>
    </message>
    <message>
        <source>where the record does not tell the aircraft&apos;s place</source>
        <translation>ohne Ort des Fluggeräts in der Aufzeichnung</translation>
    </message>
    <message>
        <source>not reached because the flight was broken off by Return</source>
        <translation>nicht erreicht, weil der Flug mit Heimkehr abgebrochen wurde</translation>
    </message>
    <message>
        <source>not reached because the flight was broken off by Land</source>
        <translation>nicht erreicht, weil der Flug mit Landen abgebrochen wurde</translation>
    </message>
    <message>
        <source>not reached because the flight was broken off for low battery</source>
        <translation>nicht erreicht, weil der Flug wegen schwachen Akkus abgebrochen wurde</translation>
    </message>
    <message>
        <source>not reached because the flight was broken off for the lost link</source>
        <translation>nicht erreicht, weil der Flug wegen verlorener Funkverbindung abgebrochen wurde</translation>
    </message>
    <message>
        <source>not reached because the flight was broken off for the lost remote control</source>
        <translation>nicht erreicht, weil der Flug wegen verlorener Fernsteuerung abgebrochen wurde</translation>
    </message>
    <message>
        <source>not reached because the flight was broken off at the fence</source>
        <translation>nicht erreicht, weil der Flug am Geofence abgebrochen wurde</translation>
    </message>
    <message>
        <source>not reached because the pilot took over by hand</source>
        <translation>nicht erreicht, weil der Pilot von Hand übernahm</translation>
    </message>
    <message>
        <source>not reached because the motors stopped in the air</source>
        <translation>nicht erreicht, weil die Motoren in der Luft ausgingen</translation>
    </message>
    <message>
        <source>1 of {0} views has no photo that is known of: {1}; {2}</source>
        <translation>1 von {0} Aufnahmen hat kein bekanntes Foto: {1}; {2}</translation>
    </message>
    <message>
        <source>all {0} views have a photo</source>
        <translation>alle {0} Aufnahmen haben ein Foto</translation>
    </message>
    <message>
        <source>1 photo belongs to no view, or to one that has a better photo; it counts for coverage, too</source>
        <translation>1 Foto gehört zu keiner Aufnahme oder zu einer, die ein besseres Foto hat; es zählt für die Abdeckung mit</translation>
    </message>
    <message>
        <source>{0} photos belong to no view, or to one that has a better photo; they count for coverage, too</source>
        <translation>{0} Fotos gehören zu keiner Aufnahme oder zu einer, die ein besseres Foto hat; auch sie zählen für die Abdeckung</translation>
    </message>
    <message>
        <source>the camera counted {0} photos whose reports did not arrive; {1} of them are of views that are known; the autopilot&apos;s own log (.BIN, .ulg) tells of all</source>
        <translation>die Kamera zählte {0} Fotos, deren Meldungen nicht ankamen; {1} davon sind von bekannten Aufnahmen; das eigene Protokoll des Autopiloten (.BIN, .ulg) nennt alle</translation>
    </message>
    <message>
        <source>position error at the shutter</source>
        <translation>Positionsfehler beim Auslösen</translation>
    </message>
    <message>
        <source>heading error at the shutter</source>
        <translation>Kursfehler beim Auslösen</translation>
    </message>
    <message>
        <source>gimbal pitch error</source>
        <translation>Neigungsfehler des Gimbals</translation>
    </message>
    <message>
        <source>motion blur</source>
        <translation>Bewegungsunschärfe</translation>
    </message>
    <message>
        <source>; coverage is counted as if they looked as planned</source>
        <translation>; die Abdeckung zählt, als blickten sie wie geplant</translation>
    </message>
    <message>
        <source>the {0} of {1} of {2} photos is not known{3}</source>
        <translation>nicht bekannt ({0}) bei {1} von {2} Fotos{3}</translation>
    </message>
    <message>
        <source>fly with RTK, hover longer, or in less wind</source>
        <translation>mit RTK fliegen, länger schweben oder bei weniger Wind</translation>
    </message>
    <message>
        <source>hover longer, or fly in less wind</source>
        <translation>länger schweben oder bei weniger Wind fliegen</translation>
    </message>
    <message>
        <source>{0} of {1} photos are over it; {2}</source>
        <translation>{0} von {1} Fotos liegen darüber; {2}</translation>
    </message>
    <message>
        <source>largest {0}</source>
        <translation>größter Wert, {0}</translation>
    </message>
    <message>
        <source>sections covered, {0} where {1} were planned</source>
        <translation>abgedeckte Sektoren, {0}, wo {1} geplant waren</translation>
    </message>
    <message>
        <source>plan a top-up flight</source>
        <translation>einen Ergänzungsflug planen</translation>
    </message>
    <message>
        <source>{0} panels of the plan are on no photo, the first is &apos;{1}&apos;</source>
        <translation>{0} Scheiben des Plans sind auf keinem Foto, die erste ist &apos;{1}&apos;</translation>
    </message>
    <message>
        <source>the panel &apos;{0}&apos; of the plan is on no photo</source>
        <translation>die Scheibe &apos;{0}&apos; des Plans ist auf keinem Foto</translation>
    </message>
    <message>
        <source>the distance kept is not known</source>
        <translation>der eingehaltene Abstand ist nicht bekannt</translation>
    </message>
    <message>
        <source>smallest distance flown, {0} s after the start</source>
        <translation>kleinster geflogener Abstand, {0} s nach dem Start</translation>
    </message>
    <message>
        <source>see where, and keep further away</source>
        <translation>nachsehen, wo, und weiter wegbleiben</translation>
    </message>
    <message>
        <source>difference between the {0} s flown and the {1} s predicted</source>
        <translation>Unterschied zwischen den geflogenen {0} s und den vorhergesagten {1} s</translation>
    </message>
    <message>
        <source>check the speeds and hover times of the aircraft&apos;s profile</source>
        <translation>Geschwindigkeiten und Schwebezeiten im Profil des Fluggeräts prüfen</translation>
    </message>
    <message>
        <source>battery left at the end, {0} used</source>
        <translation>Akku am Ende, {0} verbraucht</translation>
    </message>
    <message>
        <source> where {0} was predicted</source>
        <translation> bei vorhergesagten {0}</translation>
    </message>
    <message>
        <source>lower the endurance of the aircraft&apos;s profile</source>
        <translation>die Flugdauer im Profil des Fluggeräts senken</translation>
    </message>
    <message>
        <source>this site has no building mesh, and panels are found on one; import the coarse model of the building</source>
        <translation>dieser Standort hat kein Gebäudenetz, auf dem Scheiben gesucht werden; importieren Sie das grobe Modell des Gebäudes</translation>
    </message>
    <message>
        <source>none of the photos says where it was taken, so that panels cannot be put into 3-D</source>
        <translation>kein Foto sagt, wo es aufgenommen wurde, sodass Scheiben nicht in 3D gebracht werden können</translation>
    </message>
    <message>
        <source>solving facades</source>
        <translation>Fassaden werden berechnet</translation>
    </message>
    <message>
        <source>rendering</source>
        <translation>Bilder werden berechnet</translation>
    </message>
    <message>
        <source>trying scales</source>
        <translation>Maßstäbe werden ausprobiert</translation>
    </message>
    <message>
        <source>a line can be moved as far as its neighbours and the edge of the picture; remove the line that is in the way first</source>
        <translation>eine Linie kann bis zu ihren Nachbarn und zum Bildrand verschoben werden; entfernen Sie zuerst die Linie, die im Weg ist</translation>
    </message>
    <message>
        <source>there is a line already; point at a place between two lines, or beyond the last</source>
        <translation>da ist schon eine Linie; zeigen Sie auf eine Stelle zwischen zwei Linien oder jenseits der letzten</translation>
    </message>
    <message>
        <source>a facade needs two lines in each direction at least; add another line before this one goes</source>
        <translation>eine Fassade braucht mindestens zwei Linien in jeder Richtung; fügen Sie eine andere hinzu, bevor Sie diese entfernen</translation>
    </message>
    <message>
        <source>no panel is left: put one back before these panels are used</source>
        <translation>es ist keine Scheibe übrig: stellen Sie eine wieder her, bevor diese Scheiben verwendet werden</translation>
    </message>
    <message>
        <source>the site has no panels yet, so nothing is said of what the photos show of them</source>
        <translation>der Standort hat noch keine Scheiben, daher lässt sich nicht sagen, was die Fotos von ihnen zeigen</translation>
    </message>
    <message>
        <source>reading photos</source>
        <translation>Fotos werden gelesen</translation>
    </message>
    <message>
        <source>none of its {0} photos can be read; the first: {1}</source>
        <translation>keines der {0} Fotos darin kann gelesen werden; das erste: {1}</translation>
    </message>
    <message>
        <source>the file has no end, so that a part of the picture is missing</source>
        <translation>die Datei hat kein Ende, sodass ein Teil des Bildes fehlt</translation>
    </message>
    <message>
        <source>expected a folder of photos, found a file</source>
        <translation>ein Ordner mit Fotos wird erwartet, gefunden wurde eine Datei</translation>
    </message>
    <message>
        <source>expected a folder of photos, found nothing</source>
        <translation>ein Ordner mit Fotos wird erwartet, gefunden wurde nichts</translation>
    </message>
    <message>
        <source>holds no .jpg photo; name the folder that was copied from the camera&apos;s card</source>
        <translation>enthält kein Foto (.jpg); nennen Sie den Ordner, der von der Karte der Kamera kopiert wurde</translation>
    </message>
    <message>
        <source>is no JPEG file; only .jpg photos as the camera wrote them can be read</source>
        <translation>ist keine JPEG-Datei; nur Fotos (.jpg), wie die Kamera sie geschrieben hat, können gelesen werden</translation>
    </message>
    <message>
        <source>the JPEG file holds no picture; copy it from the card again</source>
        <translation>die JPEG-Datei enthält kein Bild; kopieren Sie sie noch einmal von der Karte</translation>
    </message>
    <message>
        <source>claims to be a picture of {0} x {1} pixels, so there is none in it; copy it from the card again</source>
        <translation>gibt sich als Bild von {0} x {1} Pixeln aus, enthält also keines; neu von der Karte kopieren</translation>
    </message>
    <message>
        <source>the JPEG header has more than {0} parts; refused as hostile</source>
        <translation>der Kopf der JPEG-Datei hat mehr als {0} Teile; als bösartig zurückgewiesen</translation>
    </message>
    <message>
        <source>the header of the JPEG file is damaged; copy it from the card again</source>
        <translation>der Kopf der JPEG-Datei ist beschädigt; kopieren Sie sie noch einmal von der Karte</translation>
    </message>
    <message>
        <source>the file ends in its header; copy it from the card again</source>
        <translation>die Datei endet in ihrem Kopf; kopieren Sie sie noch einmal von der Karte</translation>
    </message>
    <message>
        <source>the photos were taken {0} km from the site &apos;{1}&apos;; expected at most {2} km; are they the right photos, and the right site?</source>
        <translation>die Fotos wurden {0} km vom Standort &apos;{1}&apos; entfernt aufgenommen; höchstens {2} km werden erwartet; sind es die richtigen Fotos und der richtige Standort?</translation>
    </message>
    <message>
        <source>{0} of {1} photos were taken far from the site and are left out</source>
        <translation>{0} von {1} Fotos wurden weit vom Standort aufgenommen und werden ausgelassen</translation>
    </message>
    <message>
        <source>above take-off</source>
        <translation>über dem Startplatz</translation>
    </message>
    <message>
        <source>above sea level or ellipsoid</source>
        <translation>über dem Meer oder dem Ellipsoid</translation>
    </message>
    <message>
        <source>no photo says its height {0}; choose the other way of counting heights</source>
        <translation>kein Foto sagt seine Höhe {0}; wählen Sie die andere Art, Höhen zu zählen</translation>
    </message>
    <message>
        <source>{0} of {1} photos do not say their height {2}; theirs is counted the other way</source>
        <translation>{0} von {1} Fotos sagen ihre Höhe {2} nicht; ihre wird auf die andere Art gezählt</translation>
    </message>
    <message>
        <source>absolute heights</source>
        <translation>absoluten Höhen</translation>
    </message>
    <message>
        <source>heights above take-off</source>
        <translation>Höhen über dem Startplatz</translation>
    </message>
    <message>
        <source>by their {0} the photos would lie {1} m higher: the site&apos;s own height, the receiver, or the place of take-off is off by that</source>
        <translation>nach ihren {0} lägen die Fotos {1} m höher: um so viel ist die Höhe des Standorts, der Empfänger oder der Startplatz falsch</translation>
    </message>
    <message>
        <source>by their {0} the photos would lie {1} m lower: the site&apos;s own height, the receiver, or the place of take-off is off by that</source>
        <translation>nach ihren {0} lägen die Fotos {1} m tiefer: um so viel ist die Höhe des Standorts, der Empfänger oder der Startplatz falsch</translation>
    </message>
    <message>
        <source>EXIF and XMP of a photo give positions {0} m apart; EXIF&apos;s are taken</source>
        <translation>EXIF und XMP eines Fotos geben Orte an, die {0} m auseinanderliegen; die von EXIF werden genommen</translation>
    </message>
    <message>
        <source>RTK was not fixed in {0} of {1} photos: their positions are good to decimetres or metres</source>
        <translation>in {0} von {1} Fotos war RTK nicht fixiert: ihre Orte sind auf Dezimeter oder Meter genau</translation>
    </message>
    <message>
        <source>heights are counted as asked for: {0}</source>
        <translation>Höhen werden gezählt wie verlangt: {0}</translation>
    </message>
    <message>
        <source>heights are those above the ellipsoid, because RTK was fixed in all photos</source>
        <translation>es gelten die Höhen über dem Ellipsoid, weil RTK in allen Fotos fixiert war</translation>
    </message>
    <message>
        <source>heights are absolute ones, good to some metres: the photos do not say those above take-off</source>
        <translation>es gelten die absoluten Höhen, auf einige Meter genau: die Fotos sagen die über dem Startplatz nicht</translation>
    </message>
    <message>
        <source>because RTK was fixed in only {0} of {1} photos</source>
        <translation>weil RTK nur in {0} von {1} Fotos fixiert war</translation>
    </message>
    <message>
        <source>heights are those above take-off, counted from the site&apos;s home, {0}</source>
        <translation>es gelten die Höhen über dem Startplatz, gezählt vom Startplatz des Standorts, {0}</translation>
    </message>
    <message>
        <source>no line of a grid was found in any photo of this facade</source>
        <translation>in keinem Foto dieser Fassade wurde eine Linie eines Rasters gefunden</translation>
    </message>
    <message>
        <source>its pose was moved until the facade fell out of sight</source>
        <translation>seine Lage wurde verschoben, bis die Fassade nicht mehr zu sehen war</translation>
    </message>
    <message>
        <source>none of the {0} photos shows an upright facade of the coarse model; do poses and model belong to the same origin?</source>
        <translation>keines der {0} Fotos zeigt eine aufrechte Fassade des groben Modells; gehören Lagen und Modell zum selben Nullpunkt?</translation>
    </message>
    <message>
        <source>finding panels</source>
        <translation>Scheiben werden gesucht</translation>
    </message>
    <message>
        <source>a facade was left out: {0}</source>
        <translation>eine Fassade wurde ausgelassen: {0}</translation>
    </message>
    <message>
        <source>a wall with {0} panel was left out</source>
        <translation>eine Wand mit {0} Scheibe wurde ausgelassen</translation>
    </message>
    <message>
        <source>inclined lines</source>
        <translation>schräge Linien</translation>
    </message>
    <message>
        <source>edge pixels on one line</source>
        <translation>Kantenpixel auf einer Linie</translation>
    </message>
    <message>
        <source>no inclined line has edges enough for a profile through three panes</source>
        <translation>keine schräge Linie hat genug Kanten für ein Profil durch drei Scheiben</translation>
    </message>
    <message>
        <source>{0} inclined lines have edges enough for a profile through three panes</source>
        <translation>{0} schräge Linien haben genug Kanten für ein Profil durch drei Scheiben</translation>
    </message>
    <message>
        <source>{0} of {1} panels have more than four corners; a site&apos;s panels have four, so that the largest four-cornered part of each is kept</source>
        <translation>{0} von {1} Scheiben haben mehr als vier Ecken; Scheiben eines Standorts haben vier, deshalb bleibt von jeder das größte Viereck darin</translation>
    </message>
    <message>
        <source>panels repeat every {0} m, and a photo may lie {1} m off (one standard deviation), so that the facade may stand a panel off, or photos were matched a panel apart; refine the poses, or compare with a measured corner</source>
        <translation>Scheiben wiederholen sich alle {0} m, und ein Foto kann {1} m daneben liegen (eine Standardabweichung), sodass die Fassade um eine Scheibe versetzt stehen kann oder Fotos um eine Scheibe versetzt zugeordnet wurden; Posen verfeinern oder mit einer eingemessenen Ecke vergleichen</translation>
    </message>
    <message>
        <source>no grid of panels was found on any facade; choose sharper photos taken from the front</source>
        <translation>auf keiner Fassade wurde ein Raster von Scheiben gefunden; wählen Sie schärfere Fotos, die von vorn aufgenommen sind</translation>
    </message>
    <message>
        <source>facade {0}: no photo shows a grid with at least one panel</source>
        <translation>Fassade {0}: kein Foto zeigt ein Raster mit mindestens einer Scheibe</translation>
    </message>
    <message>
        <source>coverage of the photos</source>
        <translation>Abdeckung der Fotos</translation>
    </message>
    <message>
        <source>no photo shows panel &apos;{0}&apos;</source>
        <translation>kein Foto zeigt Scheibe &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>{0} of the {1} sections that the plan promised are on no photo</source>
        <translation>{0} der {1} Sektoren, die der Plan versprach, sind auf keinem Foto</translation>
    </message>
    <message>
        <source>cannot be read any more ({0})</source>
        <translation>kann nicht mehr gelesen werden ({0})</translation>
    </message>
    <message>
        <source>the file was cut off, so that part of the picture is missing; copy it again</source>
        <translation>die Datei wurde abgeschnitten, sodass ein Teil des Bildes fehlt; kopieren Sie sie noch einmal</translation>
    </message>
    <message>
        <source>the picture cannot be decoded ({0}); copy the file again</source>
        <translation>das Bild kann nicht dekodiert werden ({0}); kopieren Sie die Datei noch einmal</translation>
    </message>
    <message>
        <source>the picture cannot be decoded; copy the file again</source>
        <translation>das Bild kann nicht dekodiert werden; kopieren Sie die Datei noch einmal</translation>
    </message>
    <message>
        <source>expected a picture of {0} x {1} pixels, as the header says, got {2} x {3}; the file is damaged: copy it again</source>
        <translation>ein Bild von {0} x {1} Pixeln wird erwartet, wie der Kopf sagt, gefunden wurden {2} x {3}; die Datei ist beschädigt: kopieren Sie sie noch einmal</translation>
    </message>
    <message>
        <source>dewarp data</source>
        <translation>Entzerrungsdaten</translation>
    </message>
    <message>
        <source>calibrated focal length</source>
        <translation>kalibrierte Brennweite</translation>
    </message>
    <message>
        <source>focal length and catalogue sensor</source>
        <translation>Brennweite und Sensor des Katalogs</translation>
    </message>
    <message>
        <source>35 mm equivalent</source>
        <translation>Kleinbild-Äquivalent</translation>
    </message>
    <message>
        <source>photos of other cameras are left out ({0}); choose another camera to use those instead</source>
        <translation>Fotos anderer Kameras werden ausgelassen ({0}); wählen Sie eine andere Kamera, um stattdessen diese zu verwenden</translation>
    </message>
    <message>
        <source>use the files as the camera wrote them: programs that edit, send or share photos often take that out</source>
        <translation>verwenden Sie die Dateien, wie die Kamera sie geschrieben hat: Programme, die Fotos bearbeiten, senden oder teilen, nehmen das oft heraus</translation>
    </message>
    <message>
        <source>a position</source>
        <translation>ein Ort</translation>
    </message>
    <message>
        <source>a height</source>
        <translation>eine Höhe</translation>
    </message>
    <message>
        <source>where the camera looked</source>
        <translation>die Blickrichtung der Kamera</translation>
    </message>
    <message>
        <source>a focal length</source>
        <translation>eine Brennweite</translation>
    </message>
    <message>
        <source>{0} without {1}</source>
        <translation>{0} ohne {1}</translation>
    </message>
    <message>
        <source>there are none</source>
        <translation>es gibt keine</translation>
    </message>
    <message>
        <source>{0} of {1} photos do not say {2} and get no pose, the first {3}; {4}</source>
        <translation>{0} von {1} Fotos sagen nicht: {2}, und bekommen keine Lage, das erste {3}; {4}</translation>
    </message>
    <message>
        <source>focal lengths are from</source>
        <translation>Brennweiten stammen aus</translation>
    </message>
    <message>
        <source>{0} ({1} photos)</source>
        <translation>{0} ({1} Fotos)</translation>
    </message>
    <message>
        <source>the distortion of the lens is not known for {0} of {1} photos: straight lines may be bent by tens of pixels near the edges; refine the cameras, or use photos with dewarp data</source>
        <translation>die Verzeichnung des Objektivs ist für {0} von {1} Fotos nicht bekannt: gerade Linien können am Rand um Dutzende Pixel gebogen sein; verfeinern Sie die Kameras oder verwenden Sie Fotos mit Entzerrungsdaten</translation>
    </message>
    <message>
        <source>the {0} of {1} photos is of another picture size and not used: it gives a focal length far from that of the 35 mm equivalent; {2}</source>
        <translation>{0} von {1} Fotos gehört zu einer anderen Bildgröße und wird nicht verwendet: es ergibt eine Brennweite weit von der des Kleinbild-Äquivalents; {2}</translation>
    </message>
    <message>
        <source>{0} photos are marked to be shown turned; pixels are counted in the pictures as they are stored</source>
        <translation>{0} Fotos sollen gedreht gezeigt werden; Pixel werden in den Bildern gezählt, wie sie gespeichert sind</translation>
    </message>
    <message>
        <source>shows the same as {0}: from the same place, in the same direction</source>
        <translation>zeigt dasselbe wie {0}: vom selben Ort, in dieselbe Richtung</translation>
    </message>
    <message>
        <source>looks like {0}; nothing says where they were taken</source>
        <translation>sieht aus wie {0}; nichts sagt, wo sie aufgenommen wurden</translation>
    </message>
    <message>
        <source>checking photos</source>
        <translation>Fotos werden geprüft</translation>
    </message>
    <message>
        <source>measured on its edges</source>
        <translation>gemessen an seinen Kanten</translation>
    </message>
    <message>
        <source>by speed, exposure and distance; there are too few edges to measure it</source>
        <translation>nach Geschwindigkeit, Belichtung und Abstand; es gibt zu wenige Kanten, um sie zu messen</translation>
    </message>
    <message>
        <source>is blurred by {0} px ({1}), more than {2} px; take it again, slower</source>
        <translation>ist um {0} px unscharf ({1}), mehr als {2} px; nehmen Sie es noch einmal auf, langsamer</translation>
    </message>
    <message>
        <source>{0} % of the picture are {1}, more than {2} %; expose {3}</source>
        <translation>{0} % des Bildes sind {1}, mehr als {2} %; belichten Sie {3}</translation>
    </message>
    <message>
        <source>shows too few edges ({0}) to tell whether it is sharp</source>
        <translation>zeigt zu wenige Kanten ({0}), um zu sagen, ob es scharf ist</translation>
    </message>
    <message>
        <source>a surface needs at least {0} points of the coarse model, found {1}</source>
        <translation>eine Fläche braucht mindestens {0} Punkte des groben Modells, gefunden: {1}</translation>
    </message>
    <message>
        <source>the points of the coarse model lie on a line: they do not make a surface</source>
        <translation>die Punkte des groben Modells liegen auf einer Linie: sie ergeben keine Fläche</translation>
    </message>
    <message>
        <source>looking for facades</source>
        <translation>Fassaden werden gesucht</translation>
    </message>
    <message>
        <source>casting rays</source>
        <translation>Strahlen werden verfolgt</translation>
    </message>
    <message>
        <source>the photo does not show this facade from its front</source>
        <translation>das Foto zeigt diese Fassade nicht von vorn</translation>
    </message>
    <message>
        <source>the photo shows no area of this facade</source>
        <translation>das Foto zeigt keine Fläche dieser Fassade</translation>
    </message>
    <message>
        <source>{0} photos searched together showed no more than each by itself</source>
        <translation>{0} Fotos gemeinsam durchsucht zeigten nicht mehr als jedes für sich</translation>
    </message>
    <message>
        <source>its lines were found in {0} photos together, which were moved onto one another by up to {1} px</source>
        <translation>ihre Linien wurden in {0} Fotos gemeinsam gefunden, die um bis zu {1} px aufeinander geschoben wurden</translation>
    </message>
    <message>
        <source>find lines</source>
        <translation>Linien werden gesucht</translation>
    </message>
    <message>
        <source>compare rows</source>
        <translation>Zeilen werden verglichen</translation>
    </message>
    <message>
        <source>refine lines</source>
        <translation>Linien werden verfeinert</translation>
    </message>
    <message>
        <source>find vanishing points</source>
        <translation>Fluchtpunkte werden gesucht</translation>
    </message>
    <message>
        <source>find facades</source>
        <translation>Fassaden werden gesucht</translation>
    </message>
    <message>
        <source>straighten</source>
        <translation>wird gerade gerichtet</translation>
    </message>
    <message>
        <source>fuse views</source>
        <translation>Ansichten werden vereint</translation>
    </message>
    <message>
        <source>finding features</source>
        <translation>Merkmale werden gesucht</translation>
    </message>
    <message>
        <source>matching photos</source>
        <translation>Fotos werden einander zugeordnet</translation>
    </message>
    <message>
        <source>building the model</source>
        <translation>das Modell wird aufgebaut</translation>
    </message>
    <message>
        <source>adjusting all rays</source>
        <translation>alle Strahlen werden ausgeglichen</translation>
    </message>
    <message>
        <source>estimating accuracy</source>
        <translation>die Genauigkeit wird geschätzt</translation>
    </message>
    <message>
        <source>inverting normal equations</source>
        <translation>die Normalgleichungen werden umgekehrt</translation>
    </message>
    <message>
        <source>{0} of {1} photos have refined poses and lenses, moved by {2} m and turned by {3} degrees in the middle, by {4} m and {5} degrees at most; image points are off by {6} px</source>
        <translation>{0} von {1} Fotos haben verfeinerte Posen und Objektive, im Mittel um {2} m verschoben und um {3} Grad gedreht, höchstens um {4} m und {5} Grad; Bildpunkte liegen um {6} px daneben</translation>
    </message>
    <message>
        <source>none of the {0} photos has a refined pose; all keep their own</source>
        <translation>keines der {0} Fotos hat eine verfeinerte Pose; alle behalten ihre eigene</translation>
    </message>
    <message>
        <source>{0} of {1} photos found no place in the model, the first {2}; they keep their own poses</source>
        <translation>{0} von {1} Fotos fanden keinen Platz im Modell, das erste ist {2}; sie behalten ihre eigenen Posen</translation>
    </message>
    <message>
        <source>nothing fixes where the refined model lies; the photo keeps its own pose</source>
        <translation>nichts legt fest, wo das verfeinerte Modell liegt; das Foto behält seine eigene Pose</translation>
    </message>
    <message>
        <source>its refined position is {0} m from its own, which is {1} standard deviations; the photo keeps its own pose</source>
        <translation>seine verfeinerte Position liegt {0} m von der eigenen, das sind {1} Standardabweichungen; das Foto behält seine eigene Pose</translation>
    </message>
    <message>
        <source>its refined angles are {0} degrees from its own, which is {1} standard deviations more than for the others; the photo keeps its own pose</source>
        <translation>seine verfeinerten Winkel weichen um {0} Grad von den eigenen ab, das sind {1} Standardabweichungen mehr als bei den anderen; das Foto behält seine eigene Pose</translation>
    </message>
    <message>
        <source>its refined pose is known {0} times worse than its own; the photo keeps its own pose</source>
        <translation>seine verfeinerte Pose ist {0}-mal schlechter bekannt als die eigene; das Foto behält seine eigene Pose</translation>
    </message>
    <message>
        <source>{0} of {1} refined poses were refused, so none is used: all photos keep their own</source>
        <translation>{0} von {1} verfeinerten Posen wurden abgelehnt, deshalb wird keine verwendet: alle Fotos behalten ihre eigenen</translation>
    </message>
    <message>
        <source>the angles of all photos are off by {0} degrees in common, so it is the compass or the gimbal; refined poses are free of it</source>
        <translation>die Winkel aller Fotos weichen gemeinsam um {0} Grad ab, es liegt also am Kompass oder am Gimbal; verfeinerte Posen sind frei davon</translation>
    </message>
    <message>
        <source>the photos are linked with each other too closely for the accuracy of each pose to be computed; all count as equally good</source>
        <translation>die Fotos hängen zu eng zusammen, um die Genauigkeit jeder Pose zu berechnen; alle gelten als gleich gut</translation>
    </message>
    <message>
        <source>the photos were taken along one line: the turn of the model about it is that of the cameras&apos; angles</source>
        <translation>die Fotos wurden auf einer Linie aufgenommen: die Drehung des Modells um sie ist die der Kamerawinkel</translation>
    </message>
    <message>
        <source>the positions of {0} of {1} photos contradict the model and were not used</source>
        <translation>die Positionen von {0} der {1} Fotos widersprechen dem Modell und wurden nicht verwendet</translation>
    </message>
    <message>
        <source>refining cameras needs at least {0} photos with a pose, got {1}</source>
        <translation>um Kameras zu verfeinern, braucht es mindestens {0} Fotos mit Pose, gefunden wurden {1}</translation>
    </message>
    <message>
        <source>the {0} photos do not fit together: expected features that at least {1} of them share; photos must overlap by two thirds, and show more than mirroring glass</source>
        <translation>die {0} Fotos passen nicht zusammen: erwartet wurden Merkmale, die mindestens {1} von ihnen gemeinsam haben; Fotos müssen sich zu zwei Dritteln überlappen und mehr zeigen als spiegelndes Glas</translation>
    </message>
    <message>
        <source>COLMAP stopped while {0}: {1}</source>
        <translation>COLMAP brach ab ({0}): {1}</translation>
    </message>
    <message>
        <source>COLMAP model: {0} of its {1} images are among the {2} photos with a pose; expected at least 3; are the names in the model the paths below the folder of photos?</source>
        <translation>COLMAP-Modell: {0} seiner {1} Bilder sind unter den {2} Fotos mit Pose; erwartet werden mindestens 3; sind die Namen im Modell die Pfade unterhalb des Fotoordners?</translation>
    </message>
    <message>
        <source>COLMAP model: all photos were taken in one place, so that the model gets no scale from them</source>
        <translation>COLMAP-Modell: alle Fotos wurden an einem Ort aufgenommen, so dass das Modell keinen Maßstab von ihnen bekommt</translation>
    </message>
    <message>
        <source>COLMAP model: the photos&apos; positions contradict the model; are they photos of this model?</source>
        <translation>COLMAP-Modell: die Positionen der Fotos widersprechen dem Modell; sind es Fotos dieses Modells?</translation>
    </message>
    <message>
        <source>cannot be written ({0}); name another folder</source>
        <translation>nicht beschreibbar ({0}); nennen Sie einen anderen Ordner</translation>
    </message>
    <message>
        <source>is a whole drive, and refined poses cannot lie beside it; copy the photos first</source>
        <translation>ist ein ganzes Laufwerk, und neben ihm können keine verfeinerten Posen liegen; kopieren Sie zuerst die Fotos</translation>
    </message>
    <message>
        <source>expected a folder to write into, found none</source>
        <translation>erwartet wurde ein Ordner, in den geschrieben wird, gefunden wurde keiner</translation>
    </message>
    <message>
        <source>is write-protected; name another folder for refined poses</source>
        <translation>ist schreibgeschützt; nennen Sie einen anderen Ordner für verfeinerte Posen</translation>
    </message>
    <message>
        <source>holds something other than refined poses; name another folder</source>
        <translation>enthält etwas anderes als verfeinerte Posen; nennen Sie einen anderen Ordner</translation>
    </message>
    <message>
        <source>{0}; remove the folder {1} to have the poses refined again</source>
        <translation>{0}; entfernen Sie den Ordner {1}, um die Posen neu verfeinern zu lassen</translation>
    </message>
    <message>
        <source>names other photos than the model beside it</source>
        <translation>nennt andere Fotos als das Modell daneben</translation>
    </message>
    <message>
        <source>photo &apos;{0}&apos;: expected a covariance of 6 rows of 6 numbers</source>
        <translation>Foto &apos;{0}&apos;: erwartet wurde eine Kovarianz aus 6 Zeilen mit je 6 Zahlen</translation>
    </message>
    <message>
        <source>photo &apos;{0}&apos;: expected a covariance, got a matrix that is none</source>
        <translation>Foto &apos;{0}&apos;: erwartet wurde eine Kovarianz, gefunden wurde eine Matrix, die keine ist</translation>
    </message>
    <message>
        <source>building the scene</source>
        <translation>Szene wird gebaut</translation>
    </message>
    <message>
        <source>choosing what to simulate</source>
        <translation>Effekte werden gewählt</translation>
    </message>
    <message>
        <source>rendering the photo</source>
        <translation>Foto wird gerendert</translation>
    </message>
    <message>
        <source>near-field reflection</source>
        <translation>Spiegelung des Nahen</translation>
    </message>
    <message>
        <source>second bounce</source>
        <translation>zweite Spiegelung</translation>
    </message>
    <message>
        <source>panel tilt</source>
        <translation>Neigung der Scheiben</translation>
    </message>
    <message>
        <source>pane doubling</source>
        <translation>doppelte Spiegelbilder</translation>
    </message>
    <message>
        <source>interior see-through</source>
        <translation>Blick in die Räume</translation>
    </message>
    <message>
        <source>sun glare</source>
        <translation>Sonnenblendung</translation>
    </message>
    <message>
        <source>sky occlusion</source>
        <translation>Verdeckung des Himmels</translation>
    </message>
    <message>
        <source>lens distortion</source>
        <translation>Verzeichnung</translation>
    </message>
    <message>
        <source>exposure changes</source>
        <translation>Belichtungswechsel</translation>
    </message>
    <message>
        <source>position error</source>
        <translation>Positionsfehler</translation>
    </message>
    <message>
        <source>gimbal error</source>
        <translation>Gimbalfehler</translation>
    </message>
    <message>
        <source>grey levels</source>
        <translation>Graustufen</translation>
    </message>
    <message>
        <source>no photo shows glass</source>
        <translation>kein Foto zeigt Glas</translation>
    </message>
    <message>
        <source>the pictures are straight already</source>
        <translation>die Bilder sind schon gerade</translation>
    </message>
    <message>
        <source>the lens bends straight lines</source>
        <translation>das Objektiv krümmt gerade Linien</translation>
    </message>
    <message>
        <source>the lens loses {0} % of the light in the corners</source>
        <translation>das Objektiv verliert {0} % des Lichts in den Ecken</translation>
    </message>
    <message>
        <source>a white pixel holds {0} electrons</source>
        <translation>ein weißes Pixel fasst {0} Elektronen</translation>
    </message>
    <message>
        <source>with RTK</source>
        <translation>mit RTK</translation>
    </message>
    <message>
        <source>without RTK</source>
        <translation>ohne RTK</translation>
    </message>
    <message>
        <source>{0}, positions are off by {1} horizontally on each axis and {2} vertically</source>
        <translation>{0} liegen Positionen waagerecht um {1} je Achse und senkrecht um {2} daneben</translation>
    </message>
    <message>
        <source>headings are off by {0} degrees, pitch by {1}, roll by {2}</source>
        <translation>Richtungen liegen um {0} Grad daneben, Neigungen um {1}, Rollwinkel um {2}</translation>
    </message>
    <message>
        <source>{0} cm</source>
        <translation>{0} cm</translation>
    </message>
    <message>
        <source>the camera is held still for every photo</source>
        <translation>die Kamera wird für jedes Foto stillgehalten</translation>
    </message>
    <message>
        <source>no shutter opens</source>
        <translation>kein Verschluss öffnet sich</translation>
    </message>
    <message>
        <source>the camera moves up to {0} mm while the shutter is open; what is seen moves {1} px, what is mirrored {2} px</source>
        <translation>die Kamera bewegt sich bis zu {0} mm, während der Verschluss offen ist; Gesehenes bewegt sich um {1} px, Gespiegeltes um {2} px</translation>
    </message>
    <message>
        <source>one exposure is locked for all photos</source>
        <translation>eine Belichtung gilt für alle Fotos</translation>
    </message>
    <message>
        <source>photos would be exposed {0} to {1} stops apart from one exposure</source>
        <translation>Fotos wären um {0} bis {1} Blendenstufen anders belichtet als mit einer Belichtung</translation>
    </message>
    <message>
        <source>the sun stands {0} degrees high</source>
        <translation>die Sonne steht {0} Grad hoch</translation>
    </message>
    <message>
        <source>there are no rooms behind the panes</source>
        <translation>hinter den Scheiben sind keine Räume</translation>
    </message>
    <message>
        <source>panes let {0} % of the light through that comes from behind them</source>
        <translation>die Scheiben lassen {0} % des Lichts durch, das von hinten kommt</translation>
    </message>
    <message>
        <source>nothing near stands before the facade</source>
        <translation>nichts Nahes steht vor der Fassade</translation>
    </message>
    <message>
        <source>what is near hides {0} % of the facade</source>
        <translation>Nahes verdeckt {0} % der Fassade</translation>
    </message>
    <message>
        <source>there is nothing that light falls on</source>
        <translation>es gibt nichts, worauf Licht fällt</translation>
    </message>
    <message>
        <source>what is seen gets {0} % of the light of an open sky</source>
        <translation>was zu sehen ist, bekommt {0} % des Lichts eines offenen Himmels</translation>
    </message>
    <message>
        <source>panes are tilted by up to {0} degrees</source>
        <translation>die Scheiben sind um bis zu {0} Grad geneigt</translation>
    </message>
    <message>
        <source>the panes are flat</source>
        <translation>die Scheiben sind eben</translation>
    </message>
    <message>
        <source>panes turn by up to {0} degrees to their edges; mirror images appear {1} times as wide</source>
        <translation>die Scheiben drehen sich zu ihren Rändern um bis zu {0} Grad; Spiegelbilder erscheinen {1}-mal so breit</translation>
    </message>
    <message>
        <source>the panes are single</source>
        <translation>die Scheiben sind einfach verglast</translation>
    </message>
    <message>
        <source>sheets are {0} mm apart, the mirror images {1}</source>
        <translation>die Gläser sind {0} mm auseinander, die Spiegelbilder {1}</translation>
    </message>
    <message>
        <source>{0} m away</source>
        <translation>{0} m entfernt</translation>
    </message>
    <message>
        <source>as far as the sky</source>
        <translation>so fern wie der Himmel</translation>
    </message>
    <message>
        <source>the panes mirror nothing but the sky and the building itself</source>
        <translation>die Scheiben spiegeln nichts als den Himmel und das Gebäude selbst</translation>
    </message>
    <message>
        <source>{0} of the mirrored rays meet what is around, {1} m from the panes</source>
        <translation>{0} der gespiegelten Strahlen treffen, was ringsum steht, {1} m von den Scheiben</translation>
    </message>
    <message>
        <source>light falls on the panes at {0} to {1} degrees</source>
        <translation>Licht fällt unter {0} bis {1} Grad auf die Scheiben</translation>
    </message>
    <message>
        <source>{0} of the mirrored rays meet glass</source>
        <translation>{0} der gespiegelten Strahlen treffen Glas</translation>
    </message>
    <message>
        <source>there is no sun</source>
        <translation>es scheint keine Sonne</translation>
    </message>
    <message>
        <source>{0} of {1} photos see the sun, {2} its mirror image</source>
        <translation>{0} von {1} Fotos sehen die Sonne, {2} ihr Spiegelbild</translation>
    </message>
    <message>
        <source>no photo sees the sun or its mirror image</source>
        <translation>kein Foto sieht die Sonne oder ihr Spiegelbild</translation>
    </message>
    <message>
        <source>expected at most {0} panels, got {1}; render it in parts</source>
        <translation>höchstens {0} Scheiben erwartet, gefunden {1}; in Teilen rendern</translation>
    </message>
    <message>
        <source>reading the data set</source>
        <translation>Datensatz wird gelesen</translation>
    </message>
    <message>
        <source>there are no photos with a pose to prepare</source>
        <translation>kein Foto hat eine Pose, aus der ein Datensatz werden könnte</translation>
    </message>
    <message>
        <source>preparing photos</source>
        <translation>Fotos werden aufbereitet</translation>
    </message>
    <message>
        <source>none of the {0} photos can be read; the first: {1}</source>
        <translation>keines der {0} Fotos ist lesbar; das erste: {1}</translation>
    </message>
    <message>
        <source>writing cameras and points</source>
        <translation>Kameras und Punkte werden geschrieben</translation>
    </message>
    <message>
        <source>the picture cannot be decoded; it was left out</source>
        <translation>das Bild ist nicht lesbar; es wurde ausgelassen</translation>
    </message>
    <message>
        <source>the picture has {0} pixels, its camera {1} x {2}; it was left out</source>
        <translation>das Bild hat {0} Pixel, seine Kamera {1} x {2}; es wurde ausgelassen</translation>
    </message>
    <message>
        <source>cannot be coded as {0}</source>
        <translation>kann nicht als {0} geschrieben werden</translation>
    </message>
    <message>
        <source>is not empty; name a new folder for the data set</source>
        <translation>ist nicht leer; für den Datensatz einen neuen Ordner nennen</translation>
    </message>
    <message>
        <source>cannot be made ({0})</source>
        <translation>kann nicht angelegt werden ({0})</translation>
    </message>
    <message>
        <source>refining the mesh</source>
        <translation>das Gebäudenetz wird verfeinert</translation>
    </message>
    <message>
        <source>placing splats</source>
        <translation>Splats werden verteilt</translation>
    </message>
    <message>
        <source>colouring splats</source>
        <translation>Splats werden eingefärbt</translation>
    </message>
    <message>
        <source>counting glass</source>
        <translation>Glas wird gezählt</translation>
    </message>
    <message>
        <source>reading rays</source>
        <translation>Strahlen werden gelesen</translation>
    </message>
    <message>
        <source>choosing a model of mirrored light</source>
        <translation>ein Modell des Spiegellichts wird gewählt</translation>
    </message>
    <message>
        <source>learning reflections</source>
        <translation>Spiegellicht wird gelernt</translation>
    </message>
    <message>
        <source>training</source>
        <translation>Training</translation>
    </message>
    <message>
        <source>paused</source>
        <translation>angehalten</translation>
    </message>
    <message>
        <source>settling</source>
        <translation>Ausklingen</translation>
    </message>
    <message>
        <source>splats and the light that panels mirror, by the model that the scene calls for: near things are a scene that mirrored rays march through</source>
        <translation>Splats und das Licht, das Scheiben spiegeln, mit dem Modell, das die Szene verlangt: Nahes ist eine Szene, durch die gespiegelte Strahlen laufen</translation>
    </message>
    <message>
        <source>splats with reflectivity and base reflectance, and a network that gives mirrored light by place and direction</source>
        <translation>Splats mit Spiegelanteil und Grundreflexion, und ein Netz, das Spiegellicht nach Ort und Richtung angibt</translation>
    </message>
    <message>
        <source>one of its parts left out</source>
        <translation>einer seiner Teile weggelassen</translation>
    </message>
    <message>
        <source>flat discs whose colour depends on the direction by spherical harmonics</source>
        <translation>flache Scheibchen, deren Farbe über Kugelfunktionen von der Richtung abhängt</translation>
    </message>
    <message>
        <source>discs with albedo, metallic and roughness, shaded after blending by an environment cube (split sum), with light from other surfaces where the mirrored ray meets the known mesh</source>
        <translation>Scheibchen mit Albedo, Metallanteil und Rauheit, nach dem Überblenden schattiert durch einen Umgebungswürfel (Split Sum), mit Licht von anderen Flächen, wo der gespiegelte Strahl das bekannte Netz trifft</translation>
    </message>
    <message>
        <source>discs with diffuse colour, roughness and features, shaded after blending by a small network from features of the mirrored direction times those of the place</source>
        <translation>Scheibchen mit diffuser Farbe, Rauheit und Merkmalen, nach dem Überblenden schattiert durch ein kleines Netz aus Merkmalen der gespiegelten Richtung mal denen des Ortes</translation>
    </message>
    <message>
        <source>ellipsoids whose colour depends on the direction by spherical harmonics</source>
        <translation>Ellipsoide, deren Farbe über Kugelfunktionen von der Richtung abhängt</translation>
    </message>
    <message>
        <source>ellipsoids, each shaded for itself: diffuse colour, tint times an environment cube by its shortest axis and roughness, and harmonics for the rest</source>
        <translation>Ellipsoide, jedes für sich schattiert: diffuse Farbe, Tönung mal einem Umgebungswürfel nach kürzester Achse und Rauheit, und Kugelfunktionen für den Rest</translation>
    </message>
    <message>
        <source>small photos or a first look</source>
        <translation>kleine Fotos oder ein erster Blick</translation>
    </message>
    <message>
        <source>for photos of some hundred pixels&apos; width, or windows of larger ones</source>
        <translation>für Fotos von einigen hundert Pixeln Breite oder Ausschnitte größerer</translation>
    </message>
    <message>
        <source>the paper&apos;s network and number of steps, as far as they go</source>
        <translation>Netz und Zahl der Schritte wie in der Veröffentlichung, so weit sie kommen</translation>
    </message>
    <message>
        <source>cannot be made ({0}); name another folder</source>
        <translation>kann nicht angelegt werden ({0}); nennen Sie einen anderen Ordner</translation>
    </message>
    <message>
        <source>holds no finished model</source>
        <translation>enthält kein fertiges Modell</translation>
    </message>
    <message>
        <source>has no dataset.json; name a folder that `prepare` or `scene render` has finished</source>
        <translation>hat keine dataset.json; nennen Sie einen Ordner, den `prepare` oder `scene render` fertiggestellt hat</translation>
    </message>
    <message>
        <source>panels: expected indices 1, 2, 3 and so on; was the file edited?</source>
        <translation>panels: erwartet werden die Nummern 1, 2, 3 und so weiter; wurde die Datei bearbeitet?</translation>
    </message>
    <message>
        <source>panel {0} has next to no area; correct the site and prepare again</source>
        <translation>Scheibe {0} hat fast keine Fläche; berichtigen Sie den Standort und bereiten Sie neu auf</translation>
    </message>
    <message>
        <source>holds no images; name a folder with photos</source>
        <translation>enthält keine Bilder; nennen Sie einen Ordner mit Fotos</translation>
    </message>
    <message>
        <source>expected at least two photos, one to learn from and one to score, got {0}</source>
        <translation>erwartet werden mindestens zwei Fotos, eines zum Lernen und eines zum Bewerten; vorhanden: {0}</translation>
    </message>
    <message>
        <source>expected {0} x {1} pixels as its camera has, got {2} x {3}</source>
        <translation>erwartet werden {0} x {1} Pixel wie bei der Kamera, gefunden {2} x {3}</translation>
    </message>
    <message>
        <source>expected one channel with panel numbers, found {0}</source>
        <translation>erwartet wird ein Kanal mit Scheibennummern, gefunden: {0}</translation>
    </message>
    <message>
        <source>has panel {0}, and dataset.json {1}; is it of another run?</source>
        <translation>hat Scheibe {0}, und dataset.json {1}; stammt es aus einem anderen Lauf?</translation>
    </message>
    <message>
        <source>photos of {0} x {1} pixels cannot be made {2} times smaller; choose less</source>
        <translation>Fotos von {0} x {1} Pixeln können nicht {2}-mal kleiner gemacht werden; wählen Sie weniger</translation>
    </message>
    <message>
        <source>expected {0} channel(s) of {1} bit; make the folder again</source>
        <translation>erwartet werden {0} Kanäle mit {1} Bit; erzeugen Sie den Ordner neu</translation>
    </message>
    <message>
        <source>expected {0} x {1} pixels by its camera, got {2} x {3}; make the folder again</source>
        <translation>erwartet werden laut Kamera {0} x {1} Pixel, gefunden {2} x {3}; erzeugen Sie den Ordner neu</translation>
    </message>
    <message>
        <source>has none of the photos to be used; name a folder that has them</source>
        <translation>hat keines der Fotos, die gebraucht werden; nennen Sie einen Ordner, der sie hat</translation>
    </message>
    <message>
        <source>its photos take {0} MiB each while they are read, more than the limit of {1} MiB; allow more memory, or take smaller photos</source>
        <translation>seine Fotos brauchen je {0} MiB, während sie gelesen werden, mehr als die Grenze von {1} MiB; erlauben Sie mehr Speicher oder nehmen Sie kleinere Fotos</translation>
    </message>
    <message>
        <source>expected an image of 8 or 16 bit, found {0}</source>
        <translation>erwartet wird ein Bild mit 8 oder 16 Bit, gefunden: {0}</translation>
    </message>
    <message>
        <source>the file is empty; copy it again</source>
        <translation>die Datei ist leer; kopieren Sie sie neu</translation>
    </message>
    <message>
        <source>is no checkpoint, or damaged ({0}); begin the training anew</source>
        <translation>ist kein Zwischenstand oder beschädigt ({0}); beginnen Sie das Training neu</translation>
    </message>
    <message>
        <source>is no checkpoint; begin the training anew</source>
        <translation>ist kein Zwischenstand; beginnen Sie das Training neu</translation>
    </message>
    <message>
        <source>holds no state of a training; begin the training anew</source>
        <translation>enthält keinen Stand eines Trainings; beginnen Sie das Training neu</translation>
    </message>
    <message>
        <source>resume its training</source>
        <translation>setzen Sie sein Training fort</translation>
    </message>
    <message>
        <source>name one of `train`</source>
        <translation>nennen Sie eines, das trainiert wurde</translation>
    </message>
    <message>
        <source>holds no finished model; {0}</source>
        <translation>enthält kein fertiges Modell; {0}</translation>
    </message>
    <message>
        <source>weights.file: expected the name of a file beside it, got &apos;{0}&apos;</source>
        <translation>weights.file: erwartet wird der Name einer Datei daneben, gefunden &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>is not the file that {0} was written with; was it changed or cut off?</source>
        <translation>ist nicht die Datei, mit der {0} geschrieben wurde; wurde sie geändert oder abgeschnitten?</translation>
    </message>
    <message>
        <source>is no safetensors file, or damaged: {0}</source>
        <translation>ist keine safetensors-Datei oder beschädigt: {0}</translation>
    </message>
    <message>
        <source>holds numbers that are not finite; train again</source>
        <translation>enthält Zahlen, die nicht endlich sind; trainieren Sie neu</translation>
    </message>
    <message>
        <source>has splats on panel {0} of {1}</source>
        <translation>hat Splats auf Scheibe {0} von {1}</translation>
    </message>
    <message>
        <source>holds the weights of another model than {0} describes ({1})</source>
        <translation>enthält die Gewichte eines anderen Modells als {0} beschreibt ({1})</translation>
    </message>
    <message>
        <source>none of {0} photos has a pixel that lies whole on a panel; take larger photos or come closer, or train splats alone (--method 2dgs)</source>
        <translation>keines von {0} Fotos hat ein Pixel, das ganz auf einer Scheibe liegt; nehmen Sie größere Fotos, gehen Sie näher heran oder trainieren Sie Splats allein (2DGS)</translation>
    </message>
    <message>
        <source>none of {0} photos has a pixel that lies whole on a panel; take larger photos or come closer</source>
        <translation>keines von {0} Fotos hat ein Pixel, das ganz auf einer Scheibe liegt; nehmen Sie größere Fotos oder gehen Sie näher heran</translation>
    </message>
    <message>
        <source>its photos, cameras or panels are not those that the training was begun with; name that data set</source>
        <translation>seine Fotos, Kameras oder Scheiben sind nicht die, mit denen das Training begonnen wurde; nennen Sie jenen Datensatz</translation>
    </message>
    <message>
        <source>is of another version, or damaged ({0}); begin the training anew</source>
        <translation>ist von einer anderen Version oder beschädigt ({0}); beginnen Sie das Training neu</translation>
    </message>
    <message>
        <source>shows other panels; name the data set that the training was begun with</source>
        <translation>zeigt andere Scheiben; nennen Sie den Datensatz, mit dem das Training begonnen wurde</translation>
    </message>
    <message>
        <source>lacks the photo &apos;{0}&apos;</source>
        <translation>das Foto &apos;{0}&apos; fehlt</translation>
    </message>
    <message>
        <source>shows other panels</source>
        <translation>zeigt andere Scheiben</translation>
    </message>
    <message>
        <source>{0}; name the data set that the training was begun with</source>
        <translation>{0}; nennen Sie den Datensatz, mit dem das Training begonnen wurde</translation>
    </message>
    <message>
        <source>is damaged ({0}); begin the training anew</source>
        <translation>ist beschädigt ({0}); beginnen Sie das Training neu</translation>
    </message>
    <message>
        <source>is of a training of {0}; resume with that method</source>
        <translation>gehört zu einem Training von {0}; setzen Sie es mit jenem Verfahren fort</translation>
    </message>
    <message>
        <source>device: &apos;cuda&apos; is asked for, and torch finds no CUDA device; leave it out</source>
        <translation>device: &apos;cuda&apos; ist verlangt, und torch findet kein CUDA-Gerät; lassen Sie es weg</translation>
    </message>
    <message>
        <source>holds no training that was interrupted; begin the training anew</source>
        <translation>enthält kein Training, das abgebrochen wurde; beginnen Sie das Training neu</translation>
    </message>
    <message>
        <source>holds a training that was interrupted; resume it, name another folder, or delete {0}</source>
        <translation>enthält ein abgebrochenes Training; setzen Sie es fort, nennen Sie einen anderen Ordner, oder löschen Sie {0}</translation>
    </message>
    <message>
        <source>training failed at step {0}: {1}, and lower rates do not help{2}; train again with lower rates or fewer splats</source>
        <translation>das Training scheiterte bei Schritt {0}: {1}, und kleinere Lernraten helfen nicht{2}; trainieren Sie neu mit kleineren Lernraten oder weniger Splats</translation>
    </message>
    <message>
        <source>step {0} was undone ({1}); all rates are halved from there on</source>
        <translation>Schritt {0} wurde zurückgenommen ({1}); von da an sind alle Lernraten halbiert</translation>
    </message>
    <message>
        <source>training failed at step {0}: there is no memory for {1} splats and windows of {2} pixels{3}; train with fewer splats</source>
        <translation>das Training scheiterte bei Schritt {0}: für {1} Splats und Ausschnitte von {2} Pixeln fehlt der Speicher{3}; trainieren Sie mit weniger Splats</translation>
    </message>
    <message>
        <source>memory ran out at step {0}: windows of photos have {1} pixels from there on</source>
        <translation>der Speicher ging bei Schritt {0} aus: Ausschnitte der Fotos haben von da an {1} Pixel</translation>
    </message>
    <message>
        <source>memory ran out while splats were added</source>
        <translation>der Speicher ging aus, während Splats hinzukamen</translation>
    </message>
    <message>
        <source>; the last checkpoint, {0}, is good</source>
        <translation>; der letzte Zwischenstand, {0}, ist gut</translation>
    </message>
    <message>
        <source>training failed at step {0}: {1}; train again</source>
        <translation>das Training scheiterte bei Schritt {0}: {1}; trainieren Sie neu</translation>
    </message>
    <message>
        <source>went back to step {0}</source>
        <translation>zurück zu Schritt {0}</translation>
    </message>
    <message>
        <source>is of another model or version ({0}); begin the training anew</source>
        <translation>gehört zu einem anderen Modell oder einer anderen Version ({0}); beginnen Sie das Training neu</translation>
    </message>
    <message>
        <source>the loss is not a number</source>
        <translation>der Verlust ist keine Zahl</translation>
    </message>
    <message>
        <source>a gradient is not a number</source>
        <translation>ein Gradient ist keine Zahl</translation>
    </message>
    <message>
        <source>a weight is not a number</source>
        <translation>ein Gewicht ist keine Zahl</translation>
    </message>
    <message>
        <source>learning reflections failed: {0} at step {1} of {2}; lower the learning rates</source>
        <translation>das Lernen des Spiegellichts scheiterte: {0} bei Schritt {1} von {2}; verkleinern Sie die Lernraten</translation>
    </message>
    <message>
        <source>learning light: {0} at step {1}; all rates are halved from there on</source>
        <translation>beim Lernen des Lichts: {0} bei Schritt {1}; von da an sind alle Lernraten halbiert</translation>
    </message>
    <message>
        <source>learning reflections failed: there is no memory for batches of {0} rays at step {1} of {2}; choose a smaller model</source>
        <translation>das Lernen des Spiegellichts scheiterte: für {0} Strahlen auf einmal fehlt der Speicher, bei Schritt {1} von {2}; wählen Sie ein kleineres Modell</translation>
    </message>
    <message>
        <source>learning light: memory ran out at step {0}; batches have {1} rays from there</source>
        <translation>beim Lernen des Lichts ging der Speicher bei Schritt {0} aus; von da an sind es {1} Strahlen auf einmal</translation>
    </message>
    <message>
        <source>torch finds no CUDA device</source>
        <translation>torch findet kein CUDA-Gerät</translation>
    </message>
    <message>
        <source>gsplat is not installed (pip install &apos;reflight-groundstation[cuda]&apos;)</source>
        <translation>gsplat ist nicht installiert (pip install &apos;reflight-groundstation[cuda]&apos;)</translation>
    </message>
    <message>
        <source>gsplat&apos;s kernels are not compiled, which takes NVIDIA&apos;s CUDA toolkit</source>
        <translation>die Kernel von gsplat sind nicht übersetzt, wozu das CUDA-Toolkit von NVIDIA nötig ist</translation>
    </message>
    <message>
        <source>splats on CUDA are drawn by gsplat, and {0}; or compute on the processor</source>
        <translation>Splats auf CUDA zeichnet gsplat, und {0}; oder rechnen Sie auf dem Prozessor</translation>
    </message>
    <message>
        <source>there are no photos, so nobody knows how finely splats are seen; name a folder with photos</source>
        <translation>es gibt keine Fotos, und niemand weiß, wie fein Splats gesehen werden; nennen Sie einen Ordner mit Fotos</translation>
    </message>
    <message>
        <source>no panel, mesh or point within {0} m of the model&apos;s middle is seen by one of the {1} photos; are the poses and the points in one frame?</source>
        <translation>keine Scheibe, kein Netz und kein Punkt im Umkreis von {0} m um die Mitte des Modells ist auf einem der {1} Fotos zu sehen; liegen Posen und Punkte in einem gemeinsamen System?</translation>
    </message>
    <message>
        <source>of {0} points of photogrammetry none is away from glass, so splats cannot start from points; put some there ({1}, or a COLMAP model in {2}), or start from surfaces</source>
        <translation>von {0} Punkten der Photogrammetrie liegt keiner abseits von Glas, also können Splats nicht bei Punkten beginnen; legen Sie welche dorthin ({1} oder ein COLMAP-Modell in {2}), oder beginnen Sie auf Flächen</translation>
    </message>
    <message>
        <source>there are no panels, no mesh and no points to start from; prepare the data set again</source>
        <translation>es gibt keine Scheiben, kein Netz und keine Punkte für den Anfang; bereiten Sie den Datensatz neu auf</translation>
    </message>
    <message>
        <source>its points have no &apos;{0}&apos;</source>
        <translation>seine Punkte haben kein &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>has points whose coordinates are not finite numbers; make it again</source>
        <translation>hat Punkte, deren Koordinaten keine endlichen Zahlen sind; erzeugen Sie es neu</translation>
    </message>
    <message>
        <source>there is no model yet: it is being prepared</source>
        <translation>es gibt noch kein Modell: es wird vorbereitet</translation>
    </message>
    <message>
        <source>the picture could not be rendered ({0}); make the window smaller</source>
        <translation>das Bild konnte nicht berechnet werden ({0}); machen Sie das Fenster kleiner</translation>
    </message>
    <message>
        <source>has no photo &apos;{0}&apos;</source>
        <translation>hat kein Foto &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>near-field light</source>
        <translation>Licht aus der Nähe</translation>
    </message>
    <message>
        <source>show parallax</source>
        <translation>zeigen Parallaxe</translation>
    </message>
    <message>
        <source>show no parallax to speak of</source>
        <translation>zeigen keine nennenswerte Parallaxe</translation>
    </message>
    <message>
        <source>mirror images in unseen photos {0}: radiance grid {1} dB, environment map {2} dB</source>
        <translation>Spiegelbilder in ungesehenen Fotos {0}: Strahlungsgitter {1} dB, Umgebungsbild {2} dB</translation>
    </message>
    <message>
        <source>mirrored surroundings</source>
        <translation>gespiegelte Umgebung</translation>
    </message>
    <message>
        <source>clear mirror images</source>
        <translation>deutliche Spiegelbilder</translation>
    </message>
    <message>
        <source>no clear mirror images</source>
        <translation>keine deutlichen Spiegelbilder</translation>
    </message>
    <message>
        <source>the panes show {0}: harmonics alone {1} dB</source>
        <translation>die Scheiben zeigen {0}: Kugelfunktionen allein {1} dB</translation>
    </message>
    <message>
        <source>writing components</source>
        <translation>Bauteile werden geschrieben</translation>
    </message>
    <message>
        <source>holds no scene of objects ({0}); make one with `organise`</source>
        <translation>enthält keine Szene aus Objekten ({0}); mit `organise` eine anlegen</translation>
    </message>
    <message>
        <source>has no component &apos;{0}&apos;; it has {1}</source>
        <translation>hat kein Bauteil „{0}“; vorhanden sind {1}</translation>
    </message>
    <message>
        <source>reading components</source>
        <translation>Bauteile werden gelesen</translation>
    </message>
    <message>
        <source>has no element with the GlobalId &apos;{0}&apos;</source>
        <translation>hat kein Element mit der GlobalId „{0}“</translation>
    </message>
    <message>
        <source>component &apos;{0}&apos;: {1}</source>
        <translation>Bauteil „{0}“: {1}</translation>
    </message>
    <message>
        <source>expected {0} of int32; it is damaged, or of another program</source>
        <translation>erwartet werden {0} vom Typ int32; die Datei ist beschädigt oder von einem anderen Programm</translation>
    </message>
    <message>
        <source>has no &apos;{0}&apos; of Gaussians; it is damaged, or of another program</source>
        <translation>hat kein „{0}“ der Gauß-Splats; die Datei ist beschädigt oder von einem anderen Programm</translation>
    </message>
    <message>
        <source>expected {0} rows of float32, found {1} of shape {2}</source>
        <translation>erwartet werden {0} Zeilen float32, gefunden {1} der Form {2}</translation>
    </message>
    <message>
        <source>&apos;{0}&apos;: {1} and {2} have this name; give the GlobalId</source>
        <translation>„{0}“: {1} und {2} heißen so; die GlobalId angeben</translation>
    </message>
    <message>
        <source>&apos;{0}&apos;: there is no such object; give its name or its GlobalId</source>
        <translation>„{0}“: ein solches Objekt gibt es nicht; Namen oder GlobalId angeben</translation>
    </message>
    <message>
        <source>facts: origin: {0}; the file is damaged</source>
        <translation>facts: origin: {0}; die Datei ist beschädigt</translation>
    </message>
    <message>
        <source>there is no {0} with the key &apos;{1}&apos;</source>
        <translation>es gibt keinen Eintrag der Art {0} mit dem Schlüssel „{1}“</translation>
    </message>
    <message>
        <source>key: the {0} {1} belongs to another object, {2}</source>
        <translation>key: der Eintrag {1} ({0}) gehört zu einem anderen Objekt, {2}</translation>
    </message>
    <message>
        <source>the inspection of {0} has {1} defects; take these out first</source>
        <translation>zur Prüfung vom {0} gehören {1} Schäden; diese zuerst herausnehmen</translation>
    </message>
    <message>
        <source>the model has no object {0}</source>
        <translation>das Modell hat kein Objekt {0}</translation>
    </message>
    <message>
        <source>the object has an attribute &apos;{0}&apos; with another key</source>
        <translation>das Objekt hat eine Eigenschaft „{0}“ mit einem anderen Schlüssel</translation>
    </message>
    <message>
        <source>inspection: the object has no inspection with the key {0}</source>
        <translation>inspection: das Objekt hat keine Prüfung mit dem Schlüssel {0}</translation>
    </message>
    <message>
        <source>the records have the older version {0}; opening them for writing, as &apos;records FOLDER make&apos; does, brings them up to date</source>
        <translation>die Einträge haben die ältere Version {0}; wer sie zum Schreiben öffnet, etwa mit &apos;records FOLDER make&apos;, bringt sie auf den neuen Stand</translation>
    </message>
    <message>
        <source>the records are open for reading only</source>
        <translation>die Einträge sind nur zum Lesen geöffnet</translation>
    </message>
    <message>
        <source>the file is damaged ({0}); take a copy of it back</source>
        <translation>die Datei ist beschädigt ({0}); eine Sicherung zurückholen</translation>
    </message>
    <message>
        <source>{0} rows refer to rows that are not there; take a copy back</source>
        <translation>{0} Zeilen verweisen auf Zeilen, die fehlen; eine Sicherung zurückholen</translation>
    </message>
    <message>
        <source>is there already; nothing is written over it</source>
        <translation>ist schon da; nichts wird überschrieben</translation>
    </message>
    <message>
        <source>is a folder; expected a file with records</source>
        <translation>ist ein Ordner; erwartet wird eine Datei mit Einträgen</translation>
    </message>
    <message>
        <source>expected a file with records, found a device or a pipe</source>
        <translation>erwartet wird eine Datei mit Einträgen, gefunden wurde ein Gerät oder eine Pipe</translation>
    </message>
    <message>
        <source>the file is empty; take a copy of it back</source>
        <translation>die Datei ist leer; eine Sicherung zurückholen</translation>
    </message>
    <message>
        <source>is a SQLite file of another program, not records of ours</source>
        <translation>ist eine SQLite-Datei eines anderen Programms, keine unserer Einträge</translation>
    </message>
    <message>
        <source>the file is cut off ({0} of {1} bytes); take a copy of it back</source>
        <translation>die Datei ist abgeschnitten ({0} von {1} Bytes); eine Sicherung zurückholen</translation>
    </message>
    <message>
        <source>the file is write-protected</source>
        <translation>die Datei ist schreibgeschützt</translation>
    </message>
    <message>
        <source>another program is writing the records; waited {0} s; try again</source>
        <translation>ein anderes Programm schreibt gerade in die Einträge; {0} s gewartet; noch einmal versuchen</translation>
    </message>
    <message>
        <source>the disk is full; nothing was changed</source>
        <translation>der Datenträger ist voll; nichts wurde geändert</translation>
    </message>
    <message>
        <source>the file or its folder is write-protected, or a write was interrupted here; make the folder writable and open it for writing</source>
        <translation>die Datei oder ihr Ordner ist schreibgeschützt, oder ein Schreiben wurde hier unterbrochen; den Ordner beschreibbar machen und zum Schreiben öffnen</translation>
    </message>
    <message>
        <source>cannot be opened; is its folder there, and may it be written?</source>
        <translation>lässt sich nicht öffnen; ist der Ordner da, und darf darin geschrieben werden?</translation>
    </message>
    <message>
        <source>the disk does not answer as it should; nothing was changed</source>
        <translation>der Datenträger antwortet nicht wie erwartet; nichts wurde geändert</translation>
    </message>
    <message>
        <source>a value is too large</source>
        <translation>ein Wert ist zu groß</translation>
    </message>
    <message>
        <source>there are no records yet; make them with &apos;records FOLDER make --objects SITE&apos;</source>
        <translation>es gibt noch keine Einträge; mit &apos;records FOLDER make --objects SITE&apos; anlegen</translation>
    </message>
    <message>
        <source>expected records (a SQLite file), found something else or a file that is cut off</source>
        <translation>erwartet werden Einträge (eine SQLite-Datei), gefunden wurde etwas anderes oder eine abgeschnittene Datei</translation>
    </message>
    <message>
        <source>the file has more than {0} GiB; take a copy of it back</source>
        <translation>die Datei hat mehr als {0} GiB; eine Sicherung zurückholen</translation>
    </message>
    <message>
        <source>the file is damaged or cut off; take a copy of it back</source>
        <translation>die Datei ist beschädigt oder abgeschnitten; eine Sicherung zurückholen</translation>
    </message>
    <message>
        <source>is damaged or cannot be used ({0})</source>
        <translation>ist beschädigt oder nicht zu gebrauchen ({0})</translation>
    </message>
    <message>
        <source>expected a name without brackets, quotes and blanks around it, got &apos;{0}&apos;</source>
        <translation>erwartet wird ein Name ohne Klammern, Anführungszeichen und Leerzeichen am Rand, angegeben ist „{0}“</translation>
    </message>
    <message>
        <source>name: &apos;{0}&apos; stands for the object itself; use another name</source>
        <translation>name: „{0}“ steht für das Objekt selbst; einen anderen Namen wählen</translation>
    </message>
    <message>
        <source>follows from the corners of the pane and is not set</source>
        <translation>ergibt sich aus den Ecken der Scheibe und wird nicht eingetragen</translation>
    </message>
    <message>
        <source>{0} in {1}</source>
        <translation>{0} in {1}</translation>
    </message>
    <message>
        <source>expected a {0} in {1}, got a {2}</source>
        <translation>erwartet wird {0} in {1}, angegeben ist {2}</translation>
    </message>
    <message>
        <source>expected a {0}, got a {1}</source>
        <translation>erwartet wird {0}, angegeben ist {1}</translation>
    </message>
    <message>
        <source>expected yes or no, got {0}</source>
        <translation>erwartet wird ja oder nein, angegeben ist {0}</translation>
    </message>
    <message>
        <source>expected none while the defect is open, got {0}</source>
        <translation>erwartet wird keines, solange der Schaden offen ist, angegeben ist {0}</translation>
    </message>
    <message>
        <source>u, v: expected both or neither</source>
        <translation>u, v: erwartet werden beide oder keines</translation>
    </message>
    <message>
        <source>outline: expected none or 3 to {0} places, got {1}</source>
        <translation>outline: erwartet werden keine oder 3 bis {0} Stellen, angegeben sind {1}</translation>
    </message>
    <message>
        <source>currency: expected three letters such as EUR with every cost, got &apos;{0}&apos;</source>
        <translation>Währung: zu jedem Betrag werden drei Buchstaben wie EUR erwartet, angegeben ist „{0}“</translation>
    </message>
    <message>
        <source>sha256: expected 64 hexadecimal digits in lower case, got &apos;{0}&apos;</source>
        <translation>sha256: erwartet werden 64 Hexadezimalziffern in Kleinbuchstaben, angegeben ist „{0}“</translation>
    </message>
    <message>
        <source>expected an address (http, https) or the name of a file beside the records, got &apos;{0}&apos;</source>
        <translation>erwartet wird eine Adresse (http, https) oder der Name einer Datei neben den Einträgen, angegeben ist „{0}“</translation>
    </message>
    <message>
        <source>expected two numbers, got {0}</source>
        <translation>erwartet werden zwei Zahlen, angegeben ist {0}</translation>
    </message>
    <message>
        <source>expected an IFC GlobalId ({0} characters), got &apos;{1}&apos;</source>
        <translation>erwartet wird eine IFC-GlobalId ({0} Zeichen), angegeben ist „{1}“</translation>
    </message>
    <message>
        <source>expected text, got {0}</source>
        <translation>erwartet wird Text, angegeben ist {0}</translation>
    </message>
    <message>
        <source>expected a text, got none</source>
        <translation>erwartet wird ein Text, angegeben ist keiner</translation>
    </message>
    <message>
        <source>expected at most {0} characters, got {1}</source>
        <translation>erwartet werden höchstens {0} Zeichen, angegeben sind {1}</translation>
    </message>
    <message>
        <source>character {0} is a control character (U+{1})</source>
        <translation>Zeichen {0} ist ein Steuerzeichen (U+{1})</translation>
    </message>
    <message>
        <source>expected a date such as 2026-03-31, got {0}</source>
        <translation>erwartet wird ein Datum wie 2026-03-31, angegeben ist {0}</translation>
    </message>
    <message>
        <source>expected a number from {0} to {1}, got {2}</source>
        <translation>erwartet wird eine Zahl von {0} bis {1}, angegeben ist {2}</translation>
    </message>
    <message>
        <source>expected four points of an element, &apos;{0}&apos; has others</source>
        <translation>erwartet werden vier Punkte eines Elements, „{0}“ hat andere</translation>
    </message>
    <message>
        <source>expected at most {0} objects, got {1}</source>
        <translation>erwartet werden höchstens {0} Objekte, vorhanden sind {1}</translation>
    </message>
    <message>
        <source>&apos;{0}&apos;: another object has its GlobalId {1} already</source>
        <translation>„{0}“: ein anderes Objekt hat schon die GlobalId {1}</translation>
    </message>
    <message>
        <source>&apos;{0}&apos;: its parent {1} is no object of the layer above &apos;{2}&apos;</source>
        <translation>„{0}“: das übergeordnete {1} ist kein Objekt der Ebene über „{2}“</translation>
    </message>
    <message>
        <source>the search index is damaged; take a copy of the file back</source>
        <translation>das Suchverzeichnis ist beschädigt; eine Sicherung der Datei zurückholen</translation>
    </message>
    <message>
        <source>{0}, row {1}: {2}; the file is damaged</source>
        <translation>{0}, Zeile {1}: {2}; die Datei ist beschädigt</translation>
    </message>
    <message>
        <source>objects, row {0}: {1}; the file is damaged</source>
        <translation>objects, Zeile {0}: {1}; die Datei ist beschädigt</translation>
    </message>
    <message>
        <source>changes: holds no {0}; the file is damaged</source>
        <translation>changes: enthält keinen Eintrag der Art {0}; die Datei ist beschädigt</translation>
    </message>
    <message>
        <source>the records have version {0}, this program knows up to {1}; open them with a newer program</source>
        <translation>die Einträge haben Version {0}, dieses Programm kennt bis {1}; mit einem neueren Programm öffnen</translation>
    </message>
    <message>
        <source>holds the {0} &apos;{1}&apos;, which is none of ours; such a file is not opened</source>
        <translation>enthält {0} „{1}“, das nicht von uns ist; eine solche Datei wird nicht geöffnet</translation>
    </message>
    <message>
        <source>lacks the {0} &apos;{1}&apos;; the file is damaged or no file of ours</source>
        <translation>ohne {0} „{1}“; die Datei ist beschädigt oder keine von uns</translation>
    </message>
    <message>
        <source>its {0} &apos;{1}&apos; is not as ours are; such a file is not opened</source>
        <translation>{0} „{1}“ ist nicht wie bei uns; eine solche Datei wird nicht geöffnet</translation>
    </message>
    <message>
        <source>the picture</source>
        <translation>das Bild</translation>
    </message>
    <message>
        <source>has {0} bytes; pictures may have {1}</source>
        <translation>hat {0} Bytes; Bilder dürfen {1} haben</translation>
    </message>
    <message>
        <source>expected a PNG, JPEG or WebP picture, found other content</source>
        <translation>erwartet wird ein Bild (PNG, JPEG oder WebP), gefunden wurde anderer Inhalt</translation>
    </message>
    <message>
        <source>the file is missing; copy it back beside the records</source>
        <translation>die Datei fehlt; sie wieder neben die Einträge legen</translation>
    </message>
    <message>
        <source>is not the file that was stored; copy it back</source>
        <translation>ist nicht die Datei, die abgelegt wurde; sie zurückholen</translation>
    </message>
    <message>
        <source>the place could not be looked at ({0})</source>
        <translation>die Stelle ließ sich nicht ansehen ({0})</translation>
    </message>
    <message>
        <source>{0}; the file is damaged</source>
        <translation>{0}; die Datei ist beschädigt</translation>
    </message>
    <message>
        <source>--components: there is no component &apos;{0}&apos;; known are {1}</source>
        <translation>--components: es gibt keinen Bestandteil &apos;{0}&apos;; bekannt sind {1}</translation>
    </message>
    <message>
        <source>what this method&apos;s shading adds is not in the file: its Gaussians have their own colours only</source>
        <translation>was die Schattierung dieses Verfahrens beiträgt, ist nicht in der Datei: ihre Gaußschen haben nur ihre eigenen Farben</translation>
    </message>
    <message>
        <source>mirrored light is in the colours, as harmonics of degree 3: blurred, and it stays on the panes</source>
        <translation>gespiegeltes Licht ist in den Farben, als Kugelfunktionen vom Grad 3: verwischt, und es bleibt auf den Scheiben</translation>
    </message>
    <message>
        <source>panels show their own colour only, and mirror nothing</source>
        <translation>Scheiben zeigen nur ihre eigene Farbe und spiegeln nichts</translation>
    </message>
    <message>
        <source>{0} records of objects that the model lacks are left out</source>
        <translation>Einträge zu Objekten, die dem Modell fehlen, sind weggelassen: {0}</translation>
    </message>
    <message>
        <source>{0} files of records are missing or changed: the page says so; copy them back beside the records</source>
        <translation>{0} Dateien von Einträgen fehlen oder sind verändert: Die Seite sagt es; kopieren Sie sie zurück neben die Einträge</translation>
    </message>
    <message>
        <source>{0} pictures of records cannot be read: the page says so; attach them again</source>
        <translation>{0} Bilder von Einträgen lassen sich nicht lesen: Die Seite sagt es; hängen Sie sie neu an</translation>
    </message>
    <message>
        <source>{0} documents are too large for the page, which names them; pass them on by themselves</source>
        <translation>{0} Unterlagen sind zu groß für die Seite, die sie nennt; geben Sie sie gesondert weiter</translation>
    </message>
    <message>
        <source>reading documents</source>
        <translation>Unterlagen werden gelesen</translation>
    </message>
    <message>
        <source>reading what is attached</source>
        <translation>Anhänge werden gelesen</translation>
    </message>
    <message>
        <source>the place on Earth is not known: tiles stay in the site&apos;s own frame</source>
        <translation>der Ort auf der Erde ist nicht bekannt: Kacheln bleiben im eigenen Bezugssystem des Standorts</translation>
    </message>
    <message>
        <source>each panel is a picture of its front: mirror images in it belong to that view alone</source>
        <translation>jede Scheibe ist ein Bild ihrer Vorderseite: Spiegelbilder darin gehören nur zu dieser Ansicht</translation>
    </message>
    <message>
        <source>{0} Gaussians that nobody sees are left out</source>
        <translation>Gaußsche, die niemand sieht, sind weggelassen: {0}</translation>
    </message>
    <message>
        <source>{0} Gaussians are larger or smaller than the format has, and have its nearest size</source>
        <translation>Gaußsche, die größer oder kleiner sind, als das Format kann, haben dessen nächste Größe: {0}</translation>
    </message>
    <message>
        <source>CesiumJS: show gaussians.json and panels.json as two layers</source>
        <translation>CesiumJS: gaussians.json und panels.json als zwei Ebenen zeigen</translation>
    </message>
    <message>
        <source>CesiumJS stops at Gaussians that are not compressed: for it, show panels.json alone, or write --gaussians spz</source>
        <translation>CesiumJS hält bei Gaußschen an, die nicht komprimiert sind: dafür nur panels.json zeigen, oder --gaussians spz schreiben</translation>
    </message>
    <message>
        <source>baking panels</source>
        <translation>Spiegelungen werden in Farben übertragen</translation>
    </message>
    <message>
        <source>there is no mission format &apos;{0}&apos;; known are: {1}</source>
        <translation>es gibt kein Missionsformat „{0}“; bekannt sind: {1}</translation>
    </message>
    <message>
        <source>there is no model format &apos;{0}&apos;; known are: {1}</source>
        <translation>es gibt kein Modellformat „{0}“; bekannt sind: {1}</translation>
    </message>
    <message>
        <source>the plug-in &apos;{0}&apos; of {1}</source>
        <translation>die Erweiterung „{0}“ von {1}</translation>
    </message>
    <message>
        <source>an unknown package</source>
        <translation>einem unbekannten Paket</translation>
    </message>
    <message>
        <source>{0} is left out: {1}; update it, or remove it</source>
        <translation>{0} bleibt weg: {1}; aktualisieren oder entfernen</translation>
    </message>
    <message>
        <source>{0} failed: {1}: {2}; update it, or remove it</source>
        <translation>{0} ist gescheitert: {1}: {2}; aktualisieren oder entfernen</translation>
    </message>
    <message>
        <source>its name has other characters than a-z, 0-9, dot, hyphen and underscore</source>
        <translation>ihr Name hat andere Zeichen als a-z, 0-9, Punkt, Binde- und Unterstrich</translation>
    </message>
    <message>
        <source>there is another one of that name</source>
        <translation>es gibt schon etwas mit diesem Namen</translation>
    </message>
    <message>
        <source>expected a {0} from it, got {1}</source>
        <translation>erwartet wird von ihr {0}, gekommen ist {1}</translation>
    </message>
    <message>
        <source>expected its entry point to stand for a {0}, got {1}</source>
        <translation>ihr Einstiegspunkt muss für {0} stehen, steht aber für {1}</translation>
    </message>
    <message>
        <source>expected its entry point to stand for the path of a TOML file, got {0}</source>
        <translation>ihr Einstiegspunkt muss für den Pfad einer TOML-Datei stehen, steht aber für {0}</translation>
    </message>
    <message>
        <source>&apos;{0}&apos; has other characters than a-z, 0-9, dot, hyphen and underscore</source>
        <translation>„{0}“ hat andere Zeichen als a-z, 0-9, Punkt, Binde- und Unterstrich</translation>
    </message>
    <message>
        <source>there is another aircraft profile &apos;{0}&apos;</source>
        <translation>es gibt schon ein Fluggerät „{0}“</translation>
    </message>
    <message>
        <source>writing panels</source>
        <translation>Scheiben werden geschrieben</translation>
    </message>
    <message>
        <source>not written: its latitude is {0}°, and UTM has {1}° to {2}°</source>
        <translation>nicht geschrieben: die Breite ist {0}°, und UTM reicht von {1}° bis {2}°</translation>
    </message>
    <message>
        <source>not written: a panel has corners that are not finite</source>
        <translation>nicht geschrieben: eine Scheibe hat Ecken, die nicht endlich sind</translation>
    </message>
    <message>
        <source>the scene&apos;s origin is not finite: {0}; organise the model again</source>
        <translation>der Ursprung der Szene ist nicht endlich: {0}; das Modell neu gliedern</translation>
    </message>
    <message>
        <source>component &apos;{0}&apos;: {1}: holds numbers that are not finite or cannot be; train again</source>
        <translation>Bestandteil &apos;{0}&apos;: {1}: enthält Zahlen, die nicht endlich sind oder nicht sein können; neu lernen</translation>
    </message>
    <message>
        <source>panel &apos;{0}&apos;: its corners are not finite; import the site again</source>
        <translation>Scheibe &apos;{0}&apos;: ihre Ecken sind nicht endlich; den Standort neu einlesen</translation>
    </message>
    <message>
        <source>not written: there is no Gaussian that could be seen; choose other components</source>
        <translation>nicht geschrieben: es gibt keine Gaußsche, die zu sehen wäre; andere Bestandteile wählen</translation>
    </message>
    <message>
        <source>would have {0} GB, and a .glb has less than 4.3; choose a lower degree of harmonics, fewer facades, or 3D Tiles, which are many files</source>
        <translation>hätte {0} GB, und eine .glb hat weniger als 4.3; einen niedrigeren Grad der Kugelfunktionen, weniger Fassaden oder 3D Tiles wählen, die viele Dateien sind</translation>
    </message>
    <message>
        <source>several panels have the same GlobalId; organise the model again</source>
        <translation>mehrere Scheiben haben dieselbe GlobalId; das Modell neu gliedern</translation>
    </message>
    <message>
        <source>attribute &apos;{0}&apos;: expected finite numbers, got {1}</source>
        <translation>Merkmal &apos;{0}&apos;: endliche Zahlen erwartet, {1} erhalten</translation>
    </message>
    <message>
        <source>not written: there are no panels; choose other components</source>
        <translation>nicht geschrieben: es gibt keine Scheiben; andere Bestandteile wählen</translation>
    </message>
    <message>
        <source>not written: panel &apos;{0}&apos; has no area; import the site again</source>
        <translation>nicht geschrieben: Scheibe &apos;{0}&apos; hat keine Fläche; den Standort neu einlesen</translation>
    </message>
    <message>
        <source>not written: panel &apos;{0}&apos; would have {1} pixels on a side, and textures have {2}; choose {3} pixels per metre or fewer</source>
        <translation>nicht geschrieben: Scheibe &apos;{0}&apos; hätte {1} Pixel je Seite, und Texturen haben {2}; {3} Pixel je Meter oder weniger wählen</translation>
    </message>
    <message>
        <source>not written: {0} textures of {1} pixels would be needed, and {2} are the most; choose about {3} pixels per metre, or single facades</source>
        <translation>nicht geschrieben: {0} Texturen von {1} Pixeln wären nötig, und {2} sind das Höchste; etwa {3} Pixel je Meter wählen, oder einzelne Fassaden</translation>
    </message>
    <message>
        <source>rendering panels</source>
        <translation>Scheiben werden gezeichnet</translation>
    </message>
    <message>
        <source>counting Gaussians</source>
        <translation>Gaußsche werden gezählt</translation>
    </message>
    <message>
        <source>not written: {0} Gaussians are more than fit into an image; write single facades</source>
        <translation>nicht geschrieben: {0} Gaußsche sind mehr, als in ein Bild passen; einzelne Fassaden schreiben</translation>
    </message>
    <message>
        <source>writing images</source>
        <translation>Bilder werden geschrieben</translation>
    </message>
    <message>
        <source>choosing samples</source>
        <translation>Stichproben werden gewählt</translation>
    </message>
    <message>
        <source>choosing colours</source>
        <translation>Farben werden gewählt</translation>
    </message>
    <message>
        <source>finding colours</source>
        <translation>Farben werden gesucht</translation>
    </message>
    <message>
        <source>packing Gaussians</source>
        <translation>Gaußsche werden gepackt</translation>
    </message>
    <message>
        <source>reading Gaussians</source>
        <translation>Gaußsche werden gelesen</translation>
    </message>
    <message>
        <source>not written: a Gaussian lies {0} m from the origin; train again</source>
        <translation>nicht geschrieben: eine Gaußsche liegt {0} m vom Ursprung; neu lernen</translation>
    </message>
    <message>
        <source>compressing</source>
        <translation>wird komprimiert</translation>
    </message>
    <message>
        <source>3D Tiles lie on Earth, and the site&apos;s place is not known; set the site&apos;s origin, or ask for tiles in its local frame</source>
        <translation>3D Tiles liegen auf der Erde, und der Ort des Standorts ist nicht bekannt; den Ursprung des Standorts setzen, oder Kacheln in seinem eigenen Bezugssystem verlangen</translation>
    </message>
    <message>
        <source>nothing to write: the scene has neither Gaussians nor panels</source>
        <translation>nichts zu schreiben: die Szene hat weder Gaußsche noch Scheiben</translation>
    </message>
    <message>
        <source>USD needs the package usd-core, which is not installed: pip install &apos;reflight-groundstation[usd]&apos;</source>
        <translation>USD braucht das Paket usd-core, das nicht installiert ist: pip install &apos;reflight-groundstation[usd]&apos;</translation>
    </message>
    <message>
        <source>USD: this usd-core knows no Gaussians; install 26.3 or newer: pip install &apos;reflight-groundstation[usd]&apos;</source>
        <translation>USD: dieses usd-core kennt keine Gaußschen; 26.3 oder neuer installieren: pip install &apos;reflight-groundstation[usd]&apos;</translation>
    </message>
    <message>
        <source>writing Gaussians</source>
        <translation>Gaußsche werden geschrieben</translation>
    </message>
    <message>
        <source>cannot be written; is the disk full?</source>
        <translation>lässt sich nicht schreiben; ist der Datenträger voll?</translation>
    </message>
    <message>
        <source>expected a name that ends in {0}, got &apos;{1}&apos;</source>
        <translation>einen Namen erwartet, der auf {0} endet, &apos;{1}&apos; erhalten</translation>
    </message>
    <message>
        <source>writing the page</source>
        <translation>die Seite wird geschrieben</translation>
    </message>
    <message>
        <source>cannot be written: this is a file; name a folder</source>
        <translation>lässt sich nicht schreiben: das ist eine Datei; einen Ordner nennen</translation>
    </message>
    <message>
        <source>is a page of somebody else&apos;s; name another folder</source>
        <translation>ist eine fremde Seite; einen anderen Ordner nennen</translation>
    </message>
    <message>
        <source>has other files and no page of ours; name an empty folder, or a new one</source>
        <translation>hat andere Dateien und keine Seite von hier; einen leeren Ordner nennen, oder einen neuen</translation>
    </message>
    <message>
        <source>cannot be read ({0}); name another folder</source>
        <translation>lässt sich nicht lesen ({0}); einen anderen Ordner nennen</translation>
    </message>
    <message>
        <source>not written: the scene has no components; export at least one facade</source>
        <translation>nicht geschrieben: die Szene hat keine Bestandteile; mindestens eine Fassade exportieren</translation>
    </message>
    <message>
        <source>not written: {0} panels, a page bears {1}; export one facade</source>
        <translation>nicht geschrieben: {0} Scheiben, eine Seite trägt {1}; eine Fassade exportieren</translation>
    </message>
    <message>
        <source>not written: {0} of the scene&apos;s Gaussians holds numbers that are not finite</source>
        <translation>nicht geschrieben: {0} der Gaußschen der Szene enthält Zahlen, die nicht endlich sind</translation>
    </message>
    <message>
        <source>not written: {0} Gaussians, a page bears {1}; keep the most visible ones alone (most), or export one facade</source>
        <translation>nicht geschrieben: {0} Gaußsche, eine Seite trägt {1}; nur die am besten sichtbaren behalten (most), oder eine Fassade exportieren</translation>
    </message>
    <message>
        <source>reading pictures</source>
        <translation>Bilder werden gelesen</translation>
    </message>
    <message>
        <source>pictures of defects: more than {0} MiB after {1} of {2}, even made small; leave some out</source>
        <translation>Bilder von Schäden: mehr als {0} MiB nach {1} von {2}, auch verkleinert; einige weglassen</translation>
    </message>
    <message>
        <source>records and panels: more than {0} MiB of text; export one facade</source>
        <translation>Einträge und Scheiben: mehr als {0} MiB Text; eine Fassade exportieren</translation>
    </message>
    <message>
        <source>corners of a panel hold numbers that are not finite</source>
        <translation>Ecken einer Scheibe enthalten Zahlen, die nicht endlich sind</translation>
    </message>
    <message>
        <source>picture &apos;{0}&apos;</source>
        <translation>Bild &apos;{0}&apos;</translation>
    </message>
    <message>
        <source>has more than {0} MiB; save it smaller</source>
        <translation>hat mehr als {0} MiB; kleiner speichern</translation>
    </message>
    <message>
        <source>cannot be written as JPEG</source>
        <translation>lässt sich nicht als JPEG schreiben</translation>
    </message>
    <message>
        <source>expected a finite number, got {0}</source>
        <translation>eine endliche Zahl erwartet, {0} erhalten</translation>
    </message>
    <message>
        <source>expected a text, a number, yes or no, or places on a pane; got {0}</source>
        <translation>einen Text, eine Zahl, ja oder nein oder Stellen auf einer Scheibe erwartet; {0} erhalten</translation>
    </message>
    <message>
        <source>records: there are more than {0}; leave some out</source>
        <translation>Einträge: es sind mehr als {0}; einige weglassen</translation>
    </message>
    <message>
        <source>expected the GlobalId of an object, got {0}</source>
        <translation>die GlobalId eines Objekts erwartet, {0} erhalten</translation>
    </message>
    <message>
        <source>record: expected one of {0}, got {1}</source>
        <translation>Eintrag: eines von {0} erwartet, {1} erhalten</translation>
    </message>
    <message>
        <source>has {0} fields; at most {1} are shown</source>
        <translation>hat {0} Felder; höchstens {1} werden gezeigt</translation>
    </message>
    <message>
        <source>cannot be written: it is no file; name one</source>
        <translation>lässt sich nicht schreiben: das ist keine Datei; eine nennen</translation>
    </message>
    <message>
        <source>its Gaussians do not each have a place of their own; it is damaged</source>
        <translation>seine Gaußschen haben nicht jede einen eigenen Platz; es ist beschädigt</translation>
    </message>
    <message>
        <source>holds no objects yet; &apos;records FOLDER make&apos; takes them from a site</source>
        <translation>enthält noch keine Objekte; &apos;records FOLDER make&apos; nimmt sie von einem Standort</translation>
    </message>
    <message>
        <source>the place on earth is not known to the records: IfcSite has none</source>
        <translation>der Ort auf der Erde ist den Einträgen nicht bekannt: IfcSite hat keinen</translation>
    </message>
    <message>
        <source>the building behind the panes is not in the file</source>
        <translation>das Gebäude hinter den Scheiben ist nicht in der Datei</translation>
    </message>
    <message>
        <source>telling panels of splats</source>
        <translation>Splats werden Scheiben zugeordnet</translation>
    </message>
    <message>
        <source>has no &apos;{0}&apos; of splats; it is damaged, or of another program</source>
        <translation>hat kein &apos;{0}&apos; von Splats; es ist beschädigt oder von einem anderen Programm</translation>
    </message>
    <message>
        <source>expected shape {0}, found {1}</source>
        <translation>Form {0} erwartet, {1} gefunden</translation>
    </message>
    <message>
        <source>expected float32 (panels: int32), found {0}</source>
        <translation>float32 erwartet (panels: int32), {0} gefunden</translation>
    </message>
    <message>
        <source>panels: expected numbers from {0} on, found {1}</source>
        <translation>panels: Zahlen ab {0} erwartet, {1} gefunden</translation>
    </message>
    <message>
        <source>there is no part &apos;{0}&apos;; known are {1}</source>
        <translation>es gibt keinen Teil &apos;{0}&apos;; bekannt sind {1}</translation>
    </message>
    <message>
        <source>CesiumJS stops at Gaussians that are not compressed: for it, show panels.json alone</source>
        <translation>CesiumJS bricht bei Gaußfunktionen ab, die nicht gepackt sind: für CesiumJS nur panels.json zeigen</translation>
    </message>
    <message>
        <source>holds no objects yet: it is no model whose panels are known</source>
        <translation>hat noch keine Objekte: es ist kein Modell, dessen Scheiben bekannt sind</translation>
    </message>
    <message>
        <source>there is no signing key on this computer; set one: Key in the Fly tab</source>
        <translation>auf diesem Rechner gibt es keinen Schlüssel zum Signieren; einen setzen: Schlüssel im Reiter Fliegen</translation>
    </message>
    <message>
        <source>expected a plan file, found a mission file, and the first plan does not name an aircraft of the catalogue to read it for; make a plan of it first (Mission &gt; Import mission files)</source>
        <translation>erwartet war eine Plandatei, gefunden eine Missionsdatei, und der erste Plan nennt kein Fluggerät des Katalogs, für das sie zu lesen wäre; erst einen Plan daraus machen (Mission &gt; Mission importieren)</translation>
    </message>
    <message>
        <source>the plan has no {0}, so nothing can be placed on the globe; open its site first</source>
        <translation>der Plan hat kein {0}, daher lässt sich nichts auf der Erde platzieren; erst seinen Standort öffnen</translation>
    </message>
    <message>
        <source>the particle swarm needs a number of views (“Plan for”: number of views); it cannot look for the fewest</source>
        <translation>der Partikelschwarm braucht eine Anzahl von Aufnahmen („Planen für“: Anzahl der Aufnahmen); die kleinste Anzahl kann er nicht suchen</translation>
    </message>
    <message>
        <source>the accuracy of curved surfaces is {0}: expected a positive length in metres</source>
        <translation>die Genauigkeit gekrümmter Flächen ist {0}: erwartet ist eine positive Länge in Metern</translation>
    </message>
    <message>
        <source>its height is above the ellipsoid</source>
        <translation>seine Höhe gilt über dem Ellipsoid</translation>
    </message>
    <message>
        <source>open it on the Site tab, and plan on the Plan tab</source>
        <translation>im Reiter Standort öffnen und im Reiter Planung planen</translation>
    </message>
    <message>
        <source>{0} has no plan yet; open it and plan on the Plan tab</source>
        <translation>{0} hat noch keinen Plan; öffnen und im Reiter Planung planen</translation>
    </message>
    <message>
        <source>open it on the Site tab, and save it as a project (Project &gt; Save as)</source>
        <translation>im Reiter Standort öffnen und als Projekt speichern (Projekt &gt; Speichern unter)</translation>
    </message>
    <message>
        <source>open its site first, then the plan (Plan tab, Plans, Open plan)</source>
        <translation>erst seinen Standort öffnen, dann den Plan (Reiter Planung, Pläne, Plan öffnen)</translation>
    </message>
    <message>
        <source>it needs no import: open it on the Plan tab, and export it on the Mission tab</source>
        <translation>sie braucht keinen Import: im Reiter Planung öffnen und im Reiter Mission exportieren</translation>
    </message>
    <message>
        <source>open it on the Site tab first, then choose the mission file</source>
        <translation>erst im Reiter Standort öffnen, dann die Missionsdatei wählen</translation>
    </message>
    <message>
        <source>it needs no import: open it as a site (Site tab, Open)</source>
        <translation>sie braucht keinen Import: als Standort öffnen (Reiter Standort, Öffnen)</translation>
    </message>
    <message>
        <source>only the command line works with it</source>
        <translation>nur die Befehlszeile arbeitet damit</translation>
    </message>
    <message>
        <source>{0}; a project cannot be opened without its site: put the file back from a copy, or open the site on the Site tab, open the plans on the Plan tab and save them as a new project</source>
        <translation>{0}; ein Projekt lässt sich ohne seinen Standort nicht öffnen: die Datei aus einer Kopie zurücklegen, oder den Standort im Reiter Standort und die Pläne im Reiter Planung öffnen und als neues Projekt speichern</translation>
    </message>
    <message>
        <source>there is no project in this folder: expected project.json, or a site file with plans beside it; Project &gt; Save as makes a project of what is open</source>
        <translation>in diesem Ordner ist kein Projekt: erwartet ist project.json oder eine Standortdatei mit Plänen daneben; Projekt &gt; Speichern unter macht ein Projekt aus dem, was offen ist</translation>
    </message>
    <message>
        <source>expected one site file in a folder without project.json, found {0} ({1}); open one on the Site tab and save it as a project</source>
        <translation>in einem Ordner ohne project.json ist eine Standortdatei erwartet, gefunden {0} ({1}); eine davon im Reiter Standort öffnen und als Projekt speichern</translation>
    </message>
    <message>
        <source>import it first: Mission &gt; Import mission files</source>
        <translation>erst importieren: Mission &gt; Mission importieren</translation>
    </message>
    <message>
        <source>import it first (Site &gt; Import building model), and plan a flight over that</source>
        <translation>erst importieren (Standort &gt; Gebäude importieren) und dafür einen Flug planen</translation>
    </message>
    <message>
        <source>import it first: Site &gt; Import building model</source>
        <translation>erst importieren: Standort &gt; Gebäude importieren</translation>
    </message>
    <message>
        <source>has no dataset.json; choose the folder of a data set that is finished</source>
        <translation>hat keine dataset.json; den Ordner eines fertigen Datensatzes wählen</translation>
    </message>
    <message>
        <source>choose one that a training has finished</source>
        <translation>eines wählen, dessen Training fertig ist</translation>
    </message>
    <message>
        <source>none of {0} photos has a pixel that lies whole on a panel; take larger photos or come closer, or train splats alone (“Method”: 2DGS)</source>
        <translation>keines von {0} Fotos hat einen Bildpunkt, der ganz auf einer Scheibe liegt; größere Fotos machen, näher herangehen oder nur Splats trainieren („Methode“: 2DGS)</translation>
    </message>
    <message>
        <source>holds no scene of objects ({0}); open a finished model on the Model tab, which makes one beside it</source>
        <translation>hat keine Szene aus Objekten ({0}); im Reiter Modell ein fertiges Modell öffnen: daneben entsteht eine</translation>
    </message>
    <message>
        <source>the records have the older version {0}; the first change that is kept brings them up to date</source>
        <translation>die Aufzeichnungen haben die ältere Version {0}; die erste Änderung, die gespeichert wird, bringt sie auf den neuen Stand</translation>
    </message>
    <message>
        <source>there are no records yet; the first one that is added on the Model tab makes them</source>
        <translation>es gibt noch keine Aufzeichnungen; die erste, die im Reiter Modell hinzukommt, legt sie an</translation>
    </message>
    <message>
        <source>site &apos;{0}&apos; has no panels yet: find them in photos (Photos tab), or draw them on the building (Site tab)</source>
        <translation>Standort &apos;{0}&apos; hat noch keine Scheiben: in Fotos suchen (Reiter Fotos) oder am Gebäude zeichnen (Reiter Standort)</translation>
    </message>
    <message>
        <source>{0}, so the site has no panels yet: find them in photos (Photos tab), or draw them on the building (Site tab)</source>
        <translation>{0}, daher hat der Standort noch keine Scheiben: in Fotos suchen (Reiter Fotos) oder am Gebäude zeichnen (Reiter Standort)</translation>
    </message>
    <message>
        <source>ERROR</source>
        <translation>FEHLER</translation>
    </message>
    <message>
        <source>warning</source>
        <translation>Warnung</translation>
    </message>
    <message>
        <source>note</source>
        <translation>Hinweis</translation>
    </message>
    <message>
        <source>error</source>
        <translation>Fehler</translation>
    </message>
    <message>
        <source>terrain</source>
        <translation>Gelände</translation>
    </message>
    <message>
        <source>focal length and sensor size</source>
        <translation>Brennweite und Sensorgröße</translation>
    </message>
    <message>
        <source>focal length and focal plane resolution</source>
        <translation>Brennweite und Auflösung auf dem Sensor</translation>
    </message>
    <message>
        <source>a divisor of 90 from 1 to 90 degrees</source>
        <translation>ein Teiler von 90 von 1 bis 90 Grad</translation>
    </message>
    <message>
        <source>0 m or more</source>
        <translation>0 m oder mehr</translation>
    </message>
    <message>
        <source>0 mm or more</source>
        <translation>0 mm oder mehr</translation>
    </message>
    <message>
        <source>a positive speed</source>
        <translation>eine Geschwindigkeit über 0</translation>
    </message>
    <message>
        <source>more than 0 s</source>
        <translation>mehr als 0 s</translation>
    </message>
</context>
<context>
    <name>SettingsPage</name>
    <message>
        <source>RTK needed for take-off</source>
        <translation>Start nur mit RTK</translation>
    </message>
    <message>
        <source>Warnings are spoken</source>
        <translation>Warnungen sprechen</translation>
    </message>
    <message>
        <source>For aircraft with remote ID. The secret part proves the checksum, and is neither sent nor kept</source>
        <translation>Für Luftfahrzeuge mit Remote ID. Der geheime Teil beweist die Prüfsumme und wird weder gesendet noch behalten</translation>
    </message>
    <message>
        <source>Its name: the log book counts its flights and cycles</source>
        <translation>Sein Name: das Logbuch zählt seine Flüge und Zyklen</translation>
    </message>
    <message>
        <source>NTRIP caster, from the next connection on: USER@HOST:PORT/MOUNTPOINT</source>
        <translation>NTRIP-Caster, ab der nächsten Verbindung: USER@HOST:PORT/MOUNTPOINT</translation>
    </message>
    <message>
        <source>Kept until the program ends, and never written down</source>
        <translation>Behalten, bis das Programm endet, und nie aufgeschrieben</translation>
    </message>
    <message>
        <source>Only where the aircraft&apos;s module does not know it</source>
        <translation>Nur wo das Modul des Luftfahrzeugs sie nicht kennt</translation>
    </message>
    <message>
        <source>Battery on board</source>
        <translation>Akku an Bord</translation>
    </message>
    <message>
        <source>Operator number</source>
        <translation>Betreibernummer</translation>
    </message>
    <message>
        <source>Serial number</source>
        <translation>Seriennummer</translation>
    </message>
    <message>
        <source>RTK corrections</source>
        <translation>RTK-Korrekturen</translation>
    </message>
    <message>
        <source>Their password</source>
        <translation>Ihr Passwort</translation>
    </message>
    <message>
        <source>The camera&apos;s stream, by RTSP, or as an MPEG transport stream by UDP</source>
        <translation>Der Strom der Kamera, über RTSP oder als MPEG-Transportstrom über UDP</translation>
    </message>
    <message>
        <source>Video</source>
        <translation>Video</translation>
    </message>
    <message>
        <source>Start waits for RTK, and a warning comes when it is lost in flight.</source>
        <translation>Der Start wartet auf RTK, und geht es im Flug verloren, kommt eine Warnung.</translation>
    </message>
    <message>
        <source>Each as it comes, and again while it holds.</source>
        <translation>Jede, wenn sie kommt, und wieder, solange sie gilt.</translation>
    </message>
    <message>
        <source>This computer has no speech program: install speech-dispatcher or espeak-ng.</source>
        <translation>Dieser Rechner hat kein Sprachprogramm: speech-dispatcher oder espeak-ng installieren.</translation>
    </message>
    <message>
        <source>Operator number: its checksum is right.</source>
        <translation>Betreibernummer: ihre Prüfsumme stimmt.</translation>
    </message>
    <message>
        <source>The form is right. With the secret part the checksum can be proved.</source>
        <translation>Die Form stimmt. Mit dem geheimen Teil lässt sich die Prüfsumme beweisen.</translation>
    </message>
    <message>
        <source>No number of an EASA state: nothing about it can be proved.</source>
        <translation>Keine Nummer eines EASA-Staats: an ihr lässt sich nichts beweisen.</translation>
    </message>
</context>
<context>
    <name>SharedView</name>
    <message>
        <source>The 3-D view is being prepared ...</source>
        <translation>Die 3D-Ansicht wird vorbereitet ...</translation>
    </message>
    <message>
        <source>3-D</source>
        <translation>3D</translation>
    </message>
    <message>
        <source>The site in three dimensions</source>
        <translation>Der Standort in drei Dimensionen</translation>
    </message>
    <message>
        <source>Map</source>
        <translation>Karte</translation>
    </message>
    <message>
        <source>The site from above, on the map</source>
        <translation>Der Standort von oben, auf der Karte</translation>
    </message>
    <message>
        <source>Camera</source>
        <translation>Kamera</translation>
    </message>
    <message>
        <source>What a viewpoint will see</source>
        <translation>Was ein Aufnahmepunkt sehen wird</translation>
    </message>
</context>
<context>
    <name>Shortcuts</name>
    <message>
        <source>Everywhere</source>
        <translation>Überall</translation>
    </message>
    <message>
        <source>To the next part of the window; with Shift to the one before</source>
        <translation>Zum nächsten Teil des Fensters; mit Umschalt zum vorigen</translation>
    </message>
    <message>
        <source>{0} tab</source>
        <translation>Reiter {0}</translation>
    </message>
    <message>
        <source>Arrows</source>
        <translation>Pfeile</translation>
    </message>
    <message>
        <source>Enter</source>
        <translation>Eingabe</translation>
    </message>
    <message>
        <source>with Shift</source>
        <translation>mit Umschalt</translation>
    </message>
    <message>
        <source>3-D view</source>
        <translation>3D-Ansicht</translation>
    </message>
    <message>
        <source>Turn</source>
        <translation>Drehen</translation>
    </message>
    <message>
        <source>Nearer, farther</source>
        <translation>Näher, weiter weg</translation>
    </message>
    <message>
        <source>Show everything</source>
        <translation>Alles zeigen</translation>
    </message>
    <message>
        <source>Tools in the 3-D view</source>
        <translation>Werkzeuge in der 3D-Ansicht</translation>
    </message>
    <message>
        <source>Move what is held by a step</source>
        <translation>Was gehalten wird, einen Schritt bewegen</translation>
    </message>
    <message>
        <source>Nearer to the facade, farther from it</source>
        <translation>Näher an die Fassade, weiter weg</translation>
    </message>
    <message>
        <source>Finish</source>
        <translation>Abschließen</translation>
    </message>
    <message>
        <source>Take the last corner back</source>
        <translation>Letzte Ecke zurücknehmen</translation>
    </message>
    <message>
        <source>Put the tool away</source>
        <translation>Werkzeug weglegen</translation>
    </message>
    <message>
        <source>Map</source>
        <translation>Karte</translation>
    </message>
    <message>
        <source>Shift</source>
        <translation>Verschieben</translation>
    </message>
    <message>
        <source>Pick no place</source>
        <translation>Keinen Ort wählen</translation>
    </message>
    <message>
        <source>Camera preview</source>
        <translation>Kameravorschau</translation>
    </message>
    <message>
        <source>Fly through the sortie, or stop</source>
        <translation>Durch den Einsatz fliegen oder anhalten</translation>
    </message>
    <message>
        <source>Tree of the site</source>
        <translation>Baum des Standorts</translation>
    </message>
    <message>
        <source>Delete what is selected</source>
        <translation>Ausgewähltes löschen</translation>
    </message>
    <message>
        <source>Start, Return and Land</source>
        <translation>Start, Heimkehr und Landen</translation>
    </message>
    <message>
        <source>Hold for 0.7 s; the key of the Fly tab acts at once</source>
        <translation>0,7 s halten; die Taste des Reiters Fliegen wirkt sofort</translation>
    </message>
    <message>
        <source>Delete the line, or the panel</source>
        <translation>Linie oder Scheibe löschen</translation>
    </message>
    <message>
        <source>Tour</source>
        <translation>Rundgang</translation>
    </message>
    <message>
        <source>Leave the tour</source>
        <translation>Den Rundgang verlassen</translation>
    </message>
    <message>
        <source>Photo strip of a flight</source>
        <translation>Fotostreifen eines Flugs</translation>
    </message>
    <message>
        <source>To the view before, to the next</source>
        <translation>Zur vorigen Aufnahme, zur nächsten</translation>
    </message>
    <message>
        <source>Show the view&apos;s place</source>
        <translation>Ort der Aufnahme zeigen</translation>
    </message>
    <message>
        <source>Photos</source>
        <translation>Fotos</translation>
    </message>
    <message>
        <source>Move the line or choose the panel, else shift the picture</source>
        <translation>Linie bewegen oder Scheibe wählen, sonst das Bild verschieben</translation>
    </message>
    <message>
        <source>Move the line by ten pixels</source>
        <translation>Linie um zehn Bildpunkte bewegen</translation>
    </message>
    <message>
        <source>Show all of the photo</source>
        <translation>Das ganze Foto zeigen</translation>
    </message>
    <message>
        <source>Choose the next line</source>
        <translation>Nächste Linie wählen</translation>
    </message>
    <message>
        <source>Add a line beside it, or put the panel back</source>
        <translation>Linie daneben hinzufügen oder Scheibe zurückholen</translation>
    </message>
    <message>
        <source>The panel on or off</source>
        <translation>Scheibe ein oder aus</translation>
    </message>
    <message>
        <source>Leave the line where it is</source>
        <translation>Linie lassen, wo sie ist</translation>
    </message>
    <message>
        <source>Let go of the line or panel</source>
        <translation>Linie oder Scheibe loslassen</translation>
    </message>
    <message>
        <source>Models</source>
        <translation>Modelle</translation>
    </message>
    <message>
        <source>Fly around what is in the middle</source>
        <translation>Um die Mitte fliegen</translation>
    </message>
    <message>
        <source>Ctrl and arrows</source>
        <translation>Strg und Pfeile</translation>
    </message>
    <message>
        <source>Look elsewhere</source>
        <translation>Woandershin sehen</translation>
    </message>
    <message>
        <source>Fly: forward, left, back, right, up, down</source>
        <translation>Fliegen: vor, links, zurück, rechts, auf, ab</translation>
    </message>
    <message>
        <source>Back to the first view</source>
        <translation>Zurück zur ersten Ansicht</translation>
    </message>
    <message>
        <source>Messages</source>
        <translation>Meldungen</translation>
    </message>
    <message>
        <source>Close the list</source>
        <translation>Liste schließen</translation>
    </message>
</context>
<context>
    <name>ShortcutsDialog</name>
    <message>
        <source>Shortcuts</source>
        <translation>Tastenkürzel</translation>
    </message>
</context>
<context>
    <name>SigningBox</name>
    <message>
        <source>Signed</source>
        <translation>Signiert</translation>
    </message>
    <message>
        <source>Key</source>
        <translation>Schlüssel</translation>
    </message>
    <message>
        <source>Sign what is sent, and hear nobody who does not sign with the same key</source>
        <translation>Signieren, was gesendet wird, und niemanden hören, der nicht mit demselben Schlüssel signiert</translation>
    </message>
    <message>
        <source>Set passphrase...</source>
        <translation>Passphrase setzen...</translation>
    </message>
    <message>
        <source>Give it to the vehicle...</source>
        <translation>Dem Fluggerät geben...</translation>
    </message>
    <message>
        <source>Withdraw it from the vehicle...</source>
        <translation>Dem Fluggerät entziehen...</translation>
    </message>
    <message>
        <source>Forget it on this computer...</source>
        <translation>Auf diesem Rechner vergessen...</translation>
    </message>
    <message>
        <source>This computer keeps a key.</source>
        <translation>Dieser Rechner hat einen Schlüssel.</translation>
    </message>
    <message>
        <source>This computer keeps no key yet.</source>
        <translation>Dieser Rechner hat noch keinen Schlüssel.</translation>
    </message>
</context>
<context>
    <name>SigningController</name>
    <message>
        <source>Look for the signing key</source>
        <translation>Schlüssel für die Signatur suchen</translation>
    </message>
    <message>
        <source>Set the signing key</source>
        <translation>Schlüssel für die Signatur setzen</translation>
    </message>
    <message>
        <source>Forget the signing key</source>
        <translation>Schlüssel für die Signatur vergessen</translation>
    </message>
    <message>
        <source>Give the vehicle the key</source>
        <translation>Dem Fluggerät den Schlüssel geben</translation>
    </message>
    <message>
        <source>Withdraw the key</source>
        <translation>Schlüssel entziehen</translation>
    </message>
    <message>
        <source>Key kept. Give it to the vehicle over a cable.</source>
        <translation>Schlüssel gesetzt. Dem Fluggerät über ein Kabel geben.</translation>
    </message>
    <message>
        <source>There is no key on this computer any more.</source>
        <translation>Auf diesem Rechner ist kein Schlüssel mehr.</translation>
    </message>
    <message>
        <source>The vehicle at {0} has the key, and signs with it.</source>
        <translation>Das Fluggerät an {0} hat den Schlüssel und signiert damit.</translation>
    </message>
    <message>
        <source>The vehicle at {0} was told to sign no more.</source>
        <translation>Dem Fluggerät an {0} wurde gesagt, nicht mehr zu signieren.</translation>
    </message>
</context>
<context>
    <name>SigningQuestions</name>
    <message>
        <source>Give the vehicle the key</source>
        <translation>Dem Fluggerät den Schlüssel geben</translation>
    </message>
    <message>
        <source>The key goes to the vehicle at {0} as it is: whoever listens to that link learns it. Use a cable. From then on the vehicle obeys signed links only. Give it the key?</source>
        <translation>Der Schlüssel geht unverschlüsselt zum Fluggerät an {0}: Wer diese Verbindung abhört, kennt ihn. Ein Kabel benutzen. Von da an gehorcht das Fluggerät nur signierten Verbindungen. Den Schlüssel geben?</translation>
    </message>
    <message>
        <source>Withdraw the key from the vehicle</source>
        <translation>Dem Fluggerät den Schlüssel entziehen</translation>
    </message>
    <message>
        <source>The vehicle at {0} forgets the key, and obeys everybody who reaches it from then on. Withdraw the key?</source>
        <translation>Das Fluggerät an {0} vergisst den Schlüssel und gehorcht von da an jedem, der es erreicht. Den Schlüssel entziehen?</translation>
    </message>
    <message>
        <source>Forget the key</source>
        <translation>Schlüssel vergessen</translation>
    </message>
    <message>
        <source>Vehicles that know the key keep it, and obey this computer again only when the same passphrase is set once more. Forget the key on this computer?</source>
        <translation>Fluggeräte, die den Schlüssel kennen, behalten ihn und gehorchen diesem Rechner erst wieder, wenn dieselbe Passphrase noch einmal gesetzt wird. Den Schlüssel auf diesem Rechner vergessen?</translation>
    </message>
</context>
<context>
    <name>SimulationController</name>
    <message>
        <source>Look at the flight</source>
        <translation>Flug betrachten</translation>
    </message>
</context>
<context>
    <name>SiteDetail</name>
    <message>
        <source>What is selected on the site is shown here.</source>
        <translation>Hier erscheint, was am Standort ausgewählt ist.</translation>
    </message>
</context>
<context>
    <name>SiteEditor</name>
    <message>
        <source>Delete {0}</source>
        <translation>{0} löschen</translation>
    </message>
    <message>
        <source>Turn facade {0}</source>
        <translation>Fassade {0} drehen</translation>
    </message>
    <message>
        <source>Check the site</source>
        <translation>Standort prüfen</translation>
    </message>
</context>
<context>
    <name>SiteOpener</name>
    <message>
        <source>Open site</source>
        <translation>Standort öffnen</translation>
    </message>
    <message>
        <source>Sites (*.json);;All files (*)</source>
        <translation>Standorte (*.json);;Alle Dateien (*)</translation>
    </message>
    <message>
        <source>Building models ({0});;All files (*)</source>
        <translation>Gebäudemodelle ({0});;Alle Dateien (*)</translation>
    </message>
    <message>
        <source>Import building model</source>
        <translation>Gebäude importieren</translation>
    </message>
    <message>
        <source>Open {0}</source>
        <translation>{0} öffnen</translation>
    </message>
    <message>
        <source>Import {0}</source>
        <translation>{0} importieren</translation>
    </message>
    <message>
        <source>Office: one flat facade of 280 panels</source>
        <translation>Büro: eine ebene Fassade mit 280 Scheiben</translation>
    </message>
    <message>
        <source>Library: one curved facade of 300 panels</source>
        <translation>Bibliothek: eine gekrümmte Fassade mit 300 Scheiben</translation>
    </message>
    <message>
        <source>Court: two wings that hide each other</source>
        <translation>Hof: zwei Flügel, die einander verdecken</translation>
    </message>
    <message>
        <source>Canyon: a facade on a narrow street</source>
        <translation>Schlucht: eine Fassade an enger Straße</translation>
    </message>
    <message>
        <source>Roof: horizontal skylights</source>
        <translation>Dach: waagerechte Oberlichter</translation>
    </message>
    <message>
        <source>Tower: 3 640 panels on four sides</source>
        <translation>Turm: 3 640 Scheiben an vier Seiten</translation>
    </message>
    <message>
        <source>A single panel</source>
        <translation>Eine einzelne Scheibe</translation>
    </message>
    <message>
        <source>{0}: panels {1}, facades {2}</source>
        <translation>{0}: Scheiben {1}, Fassaden {2}</translation>
    </message>
    <message>
        <source>The plans of the site before are removed with it: {0}. Undo brings them back.</source>
        <translation>Die Pläne des vorigen Standorts werden mit entfernt: {0}. Rückgängig holt sie zurück.</translation>
    </message>
</context>
<context>
    <name>SitePage</name>
    <message>
        <source>Name of the site</source>
        <translation>Name des Standorts</translation>
    </message>
    <message>
        <source>Site origin</source>
        <translation>Nullpunkt</translation>
    </message>
    <message>
        <source>Rename site</source>
        <translation>Standort umbenennen</translation>
    </message>
    <message>
        <source>Set origin</source>
        <translation>Nullpunkt setzen</translation>
    </message>
</context>
<context>
    <name>SiteSide</name>
    <message>
        <source>Import...</source>
        <translation>Import...</translation>
    </message>
    <message>
        <source>Open...</source>
        <translation>Öffnen...</translation>
    </message>
    <message>
        <source>Bundled site</source>
        <translation>Beispiel</translation>
    </message>
    <message>
        <source>Terrain...</source>
        <translation>Gelände...</translation>
    </message>
    <message>
        <source>Open a site first: terrain belongs to its place.</source>
        <translation>Öffnen Sie zuerst einen Standort: Gelände gehört zu seinem Ort.</translation>
    </message>
    <message>
        <source>Open site...</source>
        <translation>Standort öffnen...</translation>
    </message>
    <message>
        <source>Import building model...</source>
        <translation>Gebäude importieren...</translation>
    </message>
    <message>
        <source>Delete what is selected</source>
        <translation>Ausgewähltes löschen</translation>
    </message>
</context>
<context>
    <name>SiteSummary</name>
    <message>
        <source>Panels: {0} on {1} facades, {2} of glass
Size: {3}; triangles: {4}</source>
        <translation>Scheiben: {0}, Fassaden: {1}, Glas: {2}
Größe: {3}; Dreiecke: {4}</translation>
    </message>
</context>
<context>
    <name>SiteTools</name>
    <message>
        <source>Obstacle mesh...</source>
        <translation>Hindernisnetz...</translation>
    </message>
    <message>
        <source>Add an obstacle from a mesh file in the site&apos;s coordinates (a crane, a tree)</source>
        <translation>Hindernis aus einer Netzdatei in Koordinaten des Standorts hinzufügen (Kran, Baum)</translation>
    </message>
    <message>
        <source>Add zones...</source>
        <translation>Zonen hinzufügen...</translation>
    </message>
    <message>
        <source>Add geo-zones of your authority (ED-269, ED-318, GeoJSON, KML, AIXM, OpenAir)</source>
        <translation>Geozonen Ihrer Behörde hinzufügen (ED-269, ED-318, GeoJSON, KML, AIXM, OpenAir)</translation>
    </message>
    <message>
        <source>Equal panels in a rectangle on a wall</source>
        <translation>Gleiche Scheiben in einem Rechteck an einer Wand</translation>
    </message>
    <message>
        <source>Facade grid</source>
        <translation>Fassadenraster</translation>
    </message>
    <message>
        <source>Home</source>
        <translation>Startplatz</translation>
    </message>
    <message>
        <source>Click where the aircraft takes off and lands</source>
        <translation>Klicken, wo das Fluggerät startet und landet</translation>
    </message>
    <message>
        <source>Rally point</source>
        <translation>Rally-Punkt</translation>
    </message>
    <message>
        <source>Click where the aircraft may land instead of home when it returns</source>
        <translation>Anklicken, wo das Fluggerät bei der Rückkehr statt am Startplatz landen darf</translation>
    </message>
    <message>
        <source>No-fly zone</source>
        <translation>Flugverbotszone</translation>
    </message>
    <message>
        <source>Draw a zone that must not be entered on the ground</source>
        <translation>Auf dem Boden eine Zone zeichnen, in die nicht geflogen werden darf</translation>
    </message>
    <message>
        <source>Obstacle box</source>
        <translation>Hindernisquader</translation>
    </message>
    <message>
        <source>Draw a box: two corners on the ground, then the height</source>
        <translation>Quader zeichnen: zwei Ecken am Boden, dann die Höhe</translation>
    </message>
    <message>
        <source>Zero on map</source>
        <translation>Nullpunkt auf Karte</translation>
    </message>
    <message>
        <source>Click on the map where the site&apos;s zero lies</source>
        <translation>Auf der Karte anklicken, wo der Nullpunkt des Standorts liegt</translation>
    </message>
    <message>
        <source>Airspace</source>
        <translation>Luftraum</translation>
    </message>
    <message>
        <source>Draw the box in which the aircraft must stay</source>
        <translation>Den Quader zeichnen, in dem das Fluggerät bleiben muss</translation>
    </message>
    <message>
        <source>Add obstacle {0}</source>
        <translation>Hindernis {0} hinzufügen</translation>
    </message>
    <message>
        <source>Read {0}</source>
        <translation>{0} lesen</translation>
    </message>
    <message>
        <source>Add zones of {0}</source>
        <translation>Zonen aus {0} hinzufügen</translation>
    </message>
    <message>
        <source>Geo-zones (*.json *.geojson *.kml *.xml *.txt *.openair);;All files (*)</source>
        <translation>Geozonen (*.json *.geojson *.kml *.xml *.txt *.openair);;Alle Dateien (*)</translation>
    </message>
    <message>
        <source>Geo-zones</source>
        <translation>Geozonen</translation>
    </message>
    <message>
        <source>Click where the aircraft takes off and lands. Esc cancels.</source>
        <translation>Anklicken, wo das Fluggerät startet und landet. Esc bricht ab.</translation>
    </message>
    <message>
        <source>Click where the aircraft may land when it returns. Esc cancels.</source>
        <translation>Anklicken, wo das Fluggerät bei der Rückkehr landen darf. Esc bricht ab.</translation>
    </message>
    <message>
        <source>Click where the site&apos;s zero lies: all of the site moves there. Esc cancels.</source>
        <translation>Anklicken, wo der Nullpunkt liegt: Der ganze Standort rückt dorthin. Esc bricht ab.</translation>
    </message>
    <message>
        <source>Set origin</source>
        <translation>Nullpunkt setzen</translation>
    </message>
    <message>
        <source>Draw no-fly zone</source>
        <translation>Flugverbotszone zeichnen</translation>
    </message>
    <message>
        <source>Draw obstacle</source>
        <translation>Hindernis zeichnen</translation>
    </message>
    <message>
        <source>Draw airspace</source>
        <translation>Luftraum zeichnen</translation>
    </message>
    <message>
        <source>Move home</source>
        <translation>Startplatz versetzen</translation>
    </message>
    <message>
        <source>Mark rally point</source>
        <translation>Rally-Punkt setzen</translation>
    </message>
    <message>
        <source>Obstacle mesh</source>
        <translation>Hindernisnetz</translation>
    </message>
    <message>
        <source>Meshes ({0})</source>
        <translation>Netze ({0})</translation>
    </message>
</context>
<context>
    <name>SiteTree</name>
    <message>
        <source>Show it</source>
        <translation>Zeigen</translation>
    </message>
    <message>
        <source>Rename</source>
        <translation>Umbenennen</translation>
    </message>
    <message>
        <source>Turn to the other side</source>
        <translation>Seite umdrehen</translation>
    </message>
    <message>
        <source>Delete</source>
        <translation>Löschen</translation>
    </message>
</context>
<context>
    <name>SiteTreeModel</name>
    <message>
        <source>On the site</source>
        <translation>Am Standort</translation>
    </message>
    <message>
        <source>Size</source>
        <translation>Größe</translation>
    </message>
    <message>
        <source>panels: {0}</source>
        <translation>Scheiben: {0}</translation>
    </message>
    <message>
        <source>Facades</source>
        <translation>Fassaden</translation>
    </message>
    <message>
        <source>Obstacles</source>
        <translation>Hindernisse</translation>
    </message>
    <message>
        <source>No-fly zones</source>
        <translation>Flugverbotszonen</translation>
    </message>
    <message>
        <source>Airspace</source>
        <translation>Luftraum</translation>
    </message>
    <message>
        <source>Home</source>
        <translation>Startplatz</translation>
    </message>
    <message>
        <source>Geo-zones</source>
        <translation>Geozonen</translation>
    </message>
    <message>
        <source>near: {0}</source>
        <translation>nahe: {0}</translation>
    </message>
    <message>
        <source>Rally points</source>
        <translation>Rally-Punkte</translation>
    </message>
</context>
<context>
    <name>SoraDialog</name>
    <message>
        <source>Ground risk (SORA 2.5)</source>
        <translation>Bodenrisiko (SORA 2.5)</translation>
    </message>
    <message>
        <source>Numbers with formula and source</source>
        <translation>Zahlen mit Formel und Quelle</translation>
    </message>
    <message>
        <source>Save draft ...</source>
        <translation>Entwurf speichern ...</translation>
    </message>
    <message>
        <source>Table, KML and GeoJSON into a folder</source>
        <translation>Tabelle, KML und GeoJSON in einen Ordner</translation>
    </message>
    <message>
        <source>Assessing, and letting aircraft fly away ...</source>
        <translation>Wird bewertet, mit simulierten Ausreißern ...</translation>
    </message>
    <message>
        <source>Ground risk</source>
        <translation>Bodenrisiko</translation>
    </message>
    <message>
        <source>A draft: check every number before you use it.</source>
        <translation>Ein Entwurf: prüfen Sie jede Zahl, bevor Sie sie verwenden.</translation>
    </message>
    <message>
        <source>Not assessed: {0}</source>
        <translation>Nicht bewertet: {0}</translation>
    </message>
    <message>
        <source>Not written: {0}</source>
        <translation>Nicht geschrieben: {0}</translation>
    </message>
    <message>
        <source>Save the draft into this folder</source>
        <translation>Entwurf in diesem Ordner speichern</translation>
    </message>
    <message>
        <source>Draft saved in {0}: {1}</source>
        <translation>Entwurf gespeichert in {0}: {1}</translation>
    </message>
    <message>
        <source>Save draft</source>
        <translation>Entwurf speichern</translation>
    </message>
</context>
<context>
    <name>SortieTable</name>
    <message>
        <source>Sorties</source>
        <translation>Einsätze</translation>
    </message>
    <message>
        <source>No.</source>
        <translation>Nr.</translation>
    </message>
    <message>
        <source>Photos</source>
        <translation>Fotos</translation>
    </message>
    <message>
        <source>Time</source>
        <translation>Zeit</translation>
    </message>
    <message>
        <source>Used</source>
        <translation>Akku</translation>
    </message>
    <message>
        <source>Start</source>
        <translation>Start</translation>
    </message>
    <message>
        <source>With {0:.0f} s for take-off and landing, which the height profile does not show</source>
        <translation>Mit {0:.0f} s für Start und Landung, die das Höhenprofil nicht zeigt</translation>
    </message>
    <message>
        <source>Part of the battery&apos;s endurance that the sortie takes</source>
        <translation>Anteil der Flugzeit eines Akkus, den der Einsatz braucht</translation>
    </message>
    <message>
        <source>Aircraft {0} starts at {1}</source>
        <translation>Fluggerät {0} startet bei {1}</translation>
    </message>
    <message>
        <source>Length of the flight</source>
        <translation>Länge des Flugwegs</translation>
    </message>
</context>
<context>
    <name>StartPage</name>
    <message>
        <source>Begin with a site</source>
        <translation>Mit einem Standort beginnen</translation>
    </message>
    <message>
        <source>A site holds the glass panels, the building, and where you may fly.</source>
        <translation>Ein Standort enthält die Glasscheiben, das Gebäude und den erlaubten Flugraum.</translation>
    </message>
    <message>
        <source>Import building model</source>
        <translation>Gebäude importieren</translation>
    </message>
    <message>
        <source>Open a site file</source>
        <translation>Standortdatei öffnen</translation>
    </message>
    <message>
        <source>Try a bundled site</source>
        <translation>Beispielstandort ansehen</translation>
    </message>
    <message>
        <source>IFC, CityGML, CityJSON, OBJ, PLY, GLB or STL</source>
        <translation>IFC, CityGML, CityJSON, OBJ, PLY, GLB oder STL</translation>
    </message>
    <message>
        <source>A site.json that was saved before</source>
        <translation>Eine site.json, die früher gespeichert wurde</translation>
    </message>
    <message>
        <source>To look around, and to try a plan</source>
        <translation>Zum Umsehen und Probeplanen</translation>
    </message>
    <message>
        <source>Recent projects</source>
        <translation>Zuletzt geöffnet</translation>
    </message>
    <message>
        <source>Sample project</source>
        <translation>Beispielprojekt</translation>
    </message>
    <message>
        <source>A small glass facade with everything done, from the plan to the model</source>
        <translation>Eine kleine Glasfassade, an der alles getan ist, vom Plan bis zum Modell</translation>
    </message>
    <message>
        <source>Bundled site</source>
        <translation>Beispiel</translation>
    </message>
    <message>
        <source>An office building with 280 panels, to plan and fly in simulation</source>
        <translation>Ein Bürohaus mit 280 Scheiben, zum Planen und für einen simulierten Flug</translation>
    </message>
    <message>
        <source>Open a project ...</source>
        <translation>Projekt öffnen ...</translation>
    </message>
    <message>
        <source>A folder that Reflight has saved</source>
        <translation>Ein Ordner, den Reflight gespeichert hat</translation>
    </message>
    <message>
        <source>Building model ...</source>
        <translation>Gebäudemodell ...</translation>
    </message>
    <message>
        <source>Photos of a first flight ...</source>
        <translation>Fotos eines ersten Flugs ...</translation>
    </message>
    <message>
        <source>Walls, roofs and ground are made of the photos alone</source>
        <translation>Wände, Dächer und Boden entstehen aus den Fotos allein</translation>
    </message>
    <message>
        <source>Mission of another program ...</source>
        <translation>Mission eines anderen Programms ...</translation>
    </message>
    <message>
        <source>A KMZ, .plan, .waypoints, KML or CSV file</source>
        <translation>Eine KMZ-, .plan-, .waypoints-, KML- oder CSV-Datei</translation>
    </message>
    <message>
        <source>Look around</source>
        <translation>Umsehen</translation>
    </message>
    <message>
        <source>Begin a project with</source>
        <translation>Ein Projekt beginnen mit</translation>
    </message>
    <message>
        <source>Learn</source>
        <translation>Lernen</translation>
    </message>
    <message>
        <source>Manual</source>
        <translation>Handbuch</translation>
    </message>
    <message>
        <source>Tour of the window</source>
        <translation>Rundgang durch das Fenster</translation>
    </message>
    <message>
        <source>New here? The tour shows the window in a minute; it can be left at any time.</source>
        <translation>Neu hier? Der Rundgang zeigt das Fenster in einer Minute; er kann jederzeit verlassen werden.</translation>
    </message>
    <message>
        <source>Take the tour</source>
        <translation>Rundgang beginnen</translation>
    </message>
    <message>
        <source>Not now</source>
        <translation>Jetzt nicht</translation>
    </message>
</context>
<context>
    <name>SunChart</name>
    <message>
        <source>The day of the site</source>
        <translation>Der Tag am Standort</translation>
    </message>
</context>
<context>
    <name>SunController</name>
    <message>
        <source>Look at the sun</source>
        <translation>Sonne ansehen</translation>
    </message>
    <message>
        <source>Take-off planned for {0}; the Mission tab checks the plan for it.</source>
        <translation>Start für {0} geplant; der Reiter Mission prüft den Plan dafür.</translation>
    </message>
</context>
<context>
    <name>SunPanel</name>
    <message>
        <source>Day of the flight</source>
        <translation>Tag des Fluges</translation>
    </message>
    <message>
        <source>By this computer&apos;s time zone, as all times here</source>
        <translation>In der Zeitzone dieses Computers, wie alle Zeiten hier</translation>
    </message>
    <message>
        <source>The day before</source>
        <translation>Der Tag davor</translation>
    </message>
    <message>
        <source>The next day</source>
        <translation>Der nächste Tag</translation>
    </message>
    <message>
        <source>Light and take-off times stand here, once there is a site.</source>
        <translation>Licht und Startzeiten stehen hier, sobald es einen Standort gibt.</translation>
    </message>
    <message>
        <source>Check the plan for a take-off then, on the Mission tab</source>
        <translation>Den Plan im Reiter Mission für einen Start zu dieser Zeit prüfen</translation>
    </message>
    <message>
        <source>Tall: in the sun, or a take-off that spoils no photo. Half: in part, or few. Low: shade, or many.</source>
        <translation>Hoch: in der Sonne, oder ein Start, der kein Foto verdirbt. Halb: zum Teil, oder wenige. Niedrig: Schatten, oder viele.</translation>
    </message>
    <message>
        <source>Day</source>
        <translation>Tag</translation>
    </message>
    <message>
        <source>Click a time to see what it means.</source>
        <translation>Klicken Sie auf eine Zeit, um zu sehen, was sie bedeutet.</translation>
    </message>
    <message>
        <source>Plan take-off for {0}</source>
        <translation>Start für {0} planen</translation>
    </message>
</context>
<context>
    <name>Tabs</name>
    <message>
        <source>Fly</source>
        <translation>Fliegen</translation>
    </message>
    <message>
        <source>Upload, rehearse and watch the flight</source>
        <translation>Flug hochladen, proben und überwachen</translation>
    </message>
    <message>
        <source>Mission</source>
        <translation>Mission</translation>
    </message>
    <message>
        <source>Start</source>
        <translation>Start</translation>
    </message>
    <message>
        <source>Where to begin: a sample, your projects, and three ways to a new one</source>
        <translation>Wo es beginnt: ein Beispiel, Ihre Projekte und drei Wege zu einem neuen</translation>
    </message>
    <message>
        <source>Waypoints, checks, mission files and the flight brief</source>
        <translation>Wegpunkte, Prüfungen, Missionsdateien und Flugbriefing</translation>
    </message>
    <message>
        <source>Model</source>
        <translation>Modell</translation>
    </message>
    <message>
        <source>Look at the model and the record of each panel</source>
        <translation>Modell und Akte jeder Scheibe ansehen</translation>
    </message>
    <message>
        <source>Photos</source>
        <translation>Fotos</translation>
    </message>
    <message>
        <source>Read the photos and find the glass panels</source>
        <translation>Fotos lesen und Glasscheiben finden</translation>
    </message>
    <message>
        <source>Plan</source>
        <translation>Planung</translation>
    </message>
    <message>
        <source>Choose viewpoints and routes</source>
        <translation>Aufnahmepunkte und Routen wählen</translation>
    </message>
    <message>
        <source>Reconstruct</source>
        <translation>Rekonstruktion</translation>
    </message>
    <message>
        <source>Turn the photos into a model</source>
        <translation>Aus den Fotos ein Modell machen</translation>
    </message>
    <message>
        <source>Site</source>
        <translation>Standort</translation>
    </message>
    <message>
        <source>The building, its glass, and where you may fly</source>
        <translation>Das Gebäude, sein Glas und der erlaubte Flugraum</translation>
    </message>
</context>
<context>
    <name>Terms</name>
    <message>
        <source>More in the manual</source>
        <translation>Mehr im Handbuch</translation>
    </message>
</context>
<context>
    <name>TerrainDialog</name>
    <message>
        <source>Terrain</source>
        <translation>Gelände</translation>
    </message>
    <message>
        <source>Attach terrain</source>
        <translation>Gelände hinzufügen</translation>
    </message>
    <message>
        <source>Take terrain off</source>
        <translation>Gelände entfernen</translation>
    </message>
    <message>
        <source>Close</source>
        <translation>Schließen</translation>
    </message>
    <message>
        <source>Heights above the ground count from the terrain, home is put on it, and where it has no heights nothing is planned. Trees and neighbours of a surface become obstacles.</source>
        <translation>Höhen über Grund zählen vom Gelände, der Startplatz wird darauf gesetzt, und wo es keine Höhen hat, wird nichts geplant. Bäume und Nachbarn einer Oberfläche werden Hindernisse.</translation>
    </message>
    <message>
        <source>Reading heights ...</source>
        <translation>Höhen werden gelesen ...</translation>
    </message>
    <message>
        <source>The site was changed meanwhile: attach the terrain again.</source>
        <translation>Der Standort wurde inzwischen geändert: fügen Sie das Gelände noch einmal hinzu.</translation>
    </message>
    <message>
        <source>The ground is level again.</source>
        <translation>Der Boden ist wieder eben.</translation>
    </message>
</context>
<context>
    <name>TerrainForm</name>
    <message>
        <source>Accuracy</source>
        <translation>Genauigkeit</translation>
    </message>
    <message>
        <source>Unit of heights</source>
        <translation>Einheit der Höhen</translation>
    </message>
    <message>
        <source>Step of the grid</source>
        <translation>Schritt des Gitters</translation>
    </message>
    <message>
        <source>Obstacles taller than</source>
        <translation>Hindernisse höher als</translation>
    </message>
    <message>
        <source>Heights are above</source>
        <translation>Höhen zählen ab</translation>
    </message>
    <message>
        <source>Heights of the ground</source>
        <translation>Höhen des Bodens</translation>
    </message>
    <message>
        <source>Heights with trees</source>
        <translation>Höhen mit Bäumen</translation>
    </message>
    <message>
        <source>As the files say</source>
        <translation>Wie die Dateien sagen</translation>
    </message>
    <message>
        <source>Sea level, EGM96</source>
        <translation>Meeresspiegel, EGM96</translation>
    </message>
    <message>
        <source>Sea level, EGM2008</source>
        <translation>Meeresspiegel, EGM2008</translation>
    </message>
    <message>
        <source>The ellipsoid</source>
        <translation>Das Ellipsoid</translation>
    </message>
    <message>
        <source>A national height system</source>
        <translation>Ein nationales Höhensystem</translation>
    </message>
    <message>
        <source>metres</source>
        <translation>Meter</translation>
    </message>
    <message>
        <source>feet</source>
        <translation>Fuß</translation>
    </message>
    <message>
        <source>US survey feet</source>
        <translation>US-Vermessungsfuß</translation>
    </message>
    <message>
        <source>As fine as the files</source>
        <translation>So fein wie die Dateien</translation>
    </message>
    <message>
        <source>As known of the files</source>
        <translation>Wie von den Dateien bekannt</translation>
    </message>
    <message>
        <source>How far the ground may lie off the files&apos; heights; kept on top of them</source>
        <translation>Wie weit der Boden von den Höhen der Dateien abweichen darf; kommt zu ihnen hinzu</translation>
    </message>
    <message>
        <source>Shift the terrain up or down to home</source>
        <translation>Gelände in der Höhe auf den Startplatz schieben</translation>
    </message>
    <message>
        <source>Ground</source>
        <translation>Boden</translation>
    </message>
    <message>
        <source>Surface with trees</source>
        <translation>Oberfläche mit Bäumen</translation>
    </message>
    <message>
        <source>Code of the system</source>
        <translation>Kennung des Systems</translation>
    </message>
    <message>
        <source>Coordinate system</source>
        <translation>Koordinatensystem</translation>
    </message>
</context>
<context>
    <name>ThumbnailStrip</name>
    <message>
        <source>Photos in the order of time</source>
        <translation>Fotos in zeitlicher Reihenfolge</translation>
    </message>
    <message>
        <source>cannot be decoded</source>
        <translation>kann nicht dekodiert werden</translation>
    </message>
    <message>
        <source>the file was cut off</source>
        <translation>die Datei wurde abgeschnitten</translation>
    </message>
    <message>
        <source>blurred</source>
        <translation>unscharf</translation>
    </message>
    <message>
        <source>too dark</source>
        <translation>zu dunkel</translation>
    </message>
    <message>
        <source>too bright</source>
        <translation>zu hell</translation>
    </message>
    <message>
        <source>shows the same as another one</source>
        <translation>zeigt dasselbe wie ein anderes</translation>
    </message>
    <message>
        <source>does not say where it was taken</source>
        <translation>sagt nicht, wo es aufgenommen wurde</translation>
    </message>
</context>
<context>
    <name>ToolBox</name>
    <message>
        <source>Undo</source>
        <translation>Rückgängig</translation>
    </message>
    <message>
        <source>Redo</source>
        <translation>Wiederholen</translation>
    </message>
    <message>
        <source>Move</source>
        <translation>Verschieben</translation>
    </message>
    <message>
        <source>Panel on or off</source>
        <translation>Scheibe an/aus</translation>
    </message>
    <message>
        <source>Drag a line to its place, or press it and move it with the arrows; elsewhere, drag the picture</source>
        <translation>Eine Linie an ihren Platz ziehen oder auf sie drücken und sie mit den Pfeilen verschieben; anderswo das Bild ziehen</translation>
    </message>
    <message>
        <source>A press takes a panel out, or puts it back; arrows and the space bar do the same</source>
        <translation>Ein Druck nimmt eine Scheibe heraus oder setzt sie wieder ein; Pfeile und Leertaste tun dasselbe</translation>
    </message>
    <message>
        <source>Add upright line</source>
        <translation>Senkrechte dazu</translation>
    </message>
    <message>
        <source>A press adds a vertical line of the grid</source>
        <translation>Ein Druck fügt dem Raster eine senkrechte Linie hinzu</translation>
    </message>
    <message>
        <source>Add level line</source>
        <translation>Waagrechte dazu</translation>
    </message>
    <message>
        <source>A press adds a horizontal line of the grid</source>
        <translation>Ein Druck fügt dem Raster eine waagrechte Linie hinzu</translation>
    </message>
    <message>
        <source>Delete line</source>
        <translation>Linie löschen</translation>
    </message>
    <message>
        <source>A press on a line deletes it</source>
        <translation>Ein Druck auf eine Linie löscht sie</translation>
    </message>
    <message>
        <source>To the left</source>
        <translation>Nach links</translation>
    </message>
    <message>
        <source>To the right</source>
        <translation>Nach rechts</translation>
    </message>
    <message>
        <source>Upwards</source>
        <translation>Nach oben</translation>
    </message>
    <message>
        <source>Downwards</source>
        <translation>Nach unten</translation>
    </message>
    <message>
        <source>Move the chosen line by a pixel, or choose the next panel; arrow keys do the same, Shift by ten</source>
        <translation>Die gewählte Linie um ein Pixel verschieben oder die nächste Scheibe wählen; Pfeiltasten tun dasselbe, mit Umschalt um zehn</translation>
    </message>
    <message>
        <source>Take back: {0}</source>
        <translation>Zurücknehmen: {0}</translation>
    </message>
    <message>
        <source>Do again: {0}</source>
        <translation>Noch einmal: {0}</translation>
    </message>
</context>
<context>
    <name>ToolDriver</name>
    <message>
        <source>Click a point. Esc cancels.</source>
        <translation>Einen Punkt anklicken. Esc bricht ab.</translation>
    </message>
    <message>
        <source>Click the lower left corner, as seen from outside. Esc cancels.</source>
        <translation>Die untere linke Ecke anklicken, von außen gesehen. Esc bricht ab.</translation>
    </message>
    <message>
        <source>Click the lower right corner. Shift keeps a slope, Backspace goes back.</source>
        <translation>Die untere rechte Ecke anklicken. Umschalt behält ein Gefälle, Rücktaste geht zurück.</translation>
    </message>
    <message>
        <source>Click the upper edge. Backspace goes back, Esc cancels.</source>
        <translation>Die Oberkante anklicken. Rücktaste geht zurück, Esc bricht ab.</translation>
    </message>
    <message>
        <source>Click a corner on the ground. Esc cancels.</source>
        <translation>Eine Ecke am Boden anklicken. Esc bricht ab.</translation>
    </message>
    <message>
        <source>Click more corners; Enter, a double click or the first corner ends.</source>
        <translation>Weitere Ecken anklicken; Eingabe, Doppelklick oder die erste Ecke beendet.</translation>
    </message>
    <message>
        <source>This side would cross another: click elsewhere, or Backspace to go back.</source>
        <translation>Diese Seite würde eine andere kreuzen: woanders klicken oder mit Rücktaste zurück.</translation>
    </message>
    <message>
        <source>Click the opposite corner. Backspace goes back.</source>
        <translation>Die gegenüberliegende Ecke anklicken. Rücktaste geht zurück.</translation>
    </message>
    <message>
        <source>Move up to the height and click. Backspace goes back.</source>
        <translation>Bis zur Höhe hochziehen und klicken. Rücktaste geht zurück.</translation>
    </message>
    <message>
        <source>Click where the aircraft takes off and lands. Esc cancels.</source>
        <translation>Klicken, wo das Fluggerät startet und landet. Esc bricht ab.</translation>
    </message>
    <message>
        <source>Click where the aircraft may land when it returns. Esc cancels.</source>
        <translation>Anklicken, wo das Fluggerät bei der Rückkehr landen darf. Esc bricht ab.</translation>
    </message>
    <message>
        <source>Drag the viewpoint; Shift moves it along its line of sight. Arrow and Page keys move it by 1 m, with Shift by 0.1 m. Esc ends.</source>
        <translation>Aufnahmepunkt ziehen; Umschalt bewegt ihn längs der Blickrichtung. Pfeil- und Bildtasten bewegen ihn um 1 m, mit Umschalt um 0.1 m. Esc beendet.</translation>
    </message>
    <message>
        <source>There is nothing at this place. Click on the building or on the ground.</source>
        <translation>An dieser Stelle ist nichts. Auf das Gebäude oder den Boden klicken.</translation>
    </message>
    <message>
        <source> x </source>
        <translation> x </translation>
    </message>
</context>
<context>
    <name>Tour</name>
    <message>
        <source>Back</source>
        <translation>Zurück</translation>
    </message>
    <message>
        <source>Leave</source>
        <translation>Verlassen</translation>
    </message>
    <message>
        <source>Finish</source>
        <translation>Fertig</translation>
    </message>
    <message>
        <source>Next</source>
        <translation>Weiter</translation>
    </message>
    <message>
        <source>Where to begin</source>
        <translation>Wo es beginnt</translation>
    </message>
    <message>
        <source>The sample project has every step done: look around in it, nothing can break.</source>
        <translation>Im Beispielprojekt ist jeder Schritt getan: Sehen Sie sich um, es kann nichts kaputtgehen.</translation>
    </message>
    <message>
        <source>Seven steps</source>
        <translation>Sieben Schritte</translation>
    </message>
    <message>
        <source>They stand in the order of the work. A tick says that a step is done.</source>
        <translation>Sie stehen in der Reihenfolge der Arbeit. Ein Haken sagt, dass ein Schritt erledigt ist.</translation>
    </message>
    <message>
        <source>What comes next</source>
        <translation>Was als Nächstes kommt</translation>
    </message>
    <message>
        <source>This line says what is done and what comes next. The blue button leads there.</source>
        <translation>Diese Zeile sagt, was erledigt ist und was als Nächstes kommt. Der blaue Knopf führt dorthin.</translation>
    </message>
    <message>
        <source>The view</source>
        <translation>Die Ansicht</translation>
    </message>
    <message>
        <source>The site in 3-D, on the map, or as a camera will see it. Drag to turn, wheel to zoom.</source>
        <translation>Der Standort in 3-D, auf der Karte, oder wie eine Kamera ihn sehen wird. Ziehen dreht, das Rad zoomt.</translation>
    </message>
    <message>
        <source>Help</source>
        <translation>Hilfe</translation>
    </message>
    <message>
        <source>The manual&apos;s page of this tab. A “?” beside a word says what it means.</source>
        <translation>Die Seite des Handbuchs zu diesem Reiter. Ein „?“ neben einem Wort sagt, was es bedeutet.</translation>
    </message>
    <message>
        <source>Messages</source>
        <translation>Meldungen</translation>
    </message>
    <message>
        <source>What holds now, and all that was told. What runs stands beside it, with its time.</source>
        <translation>Was jetzt gilt, und alles, was gemeldet wurde. Daneben steht, was läuft, mit seiner Zeit.</translation>
    </message>
</context>
<context>
    <name>TrialChart</name>
    <message>
        <source>Measure on this facade</source>
        <translation>An dieser Fassade messen</translation>
    </message>
    <message>
        <source>Search its photos again at several scales, and with fewer of them</source>
        <translation>Ihre Fotos noch einmal in mehreren Maßstäben durchsuchen, und mit weniger von ihnen</translation>
    </message>
    <message>
        <source>What a finer picture and more photos cost in time, and what they bring.</source>
        <translation>Was ein feineres Bild und mehr Fotos an Zeit kosten, und was sie bringen.</translation>
    </message>
    <message>
        <source>● side {0} px: {1}</source>
        <translation>● Seite {0} px: {1}</translation>
    </message>
    <message>
        <source>■ photos {0}: {1}</source>
        <translation>■ Fotos {0}: {1}</translation>
    </message>
    <message>
        <source>{0:.1f} s, no grid</source>
        <translation>{0:.1f} s, kein Raster</translation>
    </message>
    <message>
        <source>{0:.1f} s, {1} panels, ± {2:.3g} {3}</source>
        <translation>{0:.1f} s, {1} Scheiben, ± {2:.3g} {3}</translation>
    </message>
</context>
<context>
    <name>TrialPlot</name>
    <message>
        <source>Accuracy of corners against the time of the search</source>
        <translation>Genauigkeit der Ecken gegen die Zeit der Suche</translation>
    </message>
    <message>
        <source>± {0} at a corner</source>
        <translation>± {0} an einer Ecke</translation>
    </message>
    <message>
        <source>time of the search in s</source>
        <translation>Zeit der Suche in s</translation>
    </message>
</context>
<context>
    <name>ViewBar</name>
    <message>
        <source>To the photo</source>
        <translation>Zum Foto</translation>
    </message>
    <message>
        <source>Show the view from where the photo was taken (0)</source>
        <translation>Den Blick von dort zeigen, wo das Foto aufgenommen wurde (0)</translation>
    </message>
    <message>
        <source>What the picture is made of</source>
        <translation>Woraus das Bild besteht</translation>
    </message>
    <message>
        <source>Model</source>
        <translation>Modell</translation>
    </message>
    <message>
        <source>Layer</source>
        <translation>Ebene</translation>
    </message>
    <message>
        <source>Beside it</source>
        <translation>Daneben</translation>
    </message>
    <message>
        <source>none yet</source>
        <translation>noch keines</translation>
    </message>
    <message>
        <source>nothing</source>
        <translation>nichts</translation>
    </message>
    <message>
        <source>the photo</source>
        <translation>das Foto</translation>
    </message>
</context>
<context>
    <name>ViewPane</name>
    <message>
        <source>Worst first</source>
        <translation>Schlechteste zuerst</translation>
    </message>
    <message>
        <source>in training</source>
        <translation>im Training</translation>
    </message>
    <message>
        <source>trained last</source>
        <translation>zuletzt trainiert</translation>
    </message>
    <message>
        <source>Line between the two pictures</source>
        <translation>Linie zwischen den beiden Bildern</translation>
    </message>
    <message>
        <source>Sort the photos by how well the model shows them now</source>
        <translation>Die Fotos danach ordnen, wie gut das Modell sie jetzt zeigt</translation>
    </message>
    <message>
        <source>photo</source>
        <translation>Foto</translation>
    </message>
    <message>
        <source>step {0}</source>
        <translation>Schritt {0}</translation>
    </message>
    <message>
        <source>{0}: violet {1}, yellow {2}</source>
        <translation>{0}: violett {1}, gelb {2}</translation>
    </message>
    <message>
        <source>Choose a data set, or make one of the flight&apos;s photos on the Photos tab.</source>
        <translation>Einen Datensatz wählen oder im Reiter Fotos aus den Fotos des Flugs anlegen.</translation>
    </message>
    <message>
        <source>A photo of the data set. The model is shown here once it learns.</source>
        <translation>Ein Foto des Datensatzes. Das Modell erscheint hier, sobald es lernt.</translation>
    </message>
    <message>
        <source>The photo is seen from its own place only; 0 goes back there.</source>
        <translation>Das Foto ist nur von seinem eigenen Ort aus zu sehen; 0 führt dorthin zurück.</translation>
    </message>
</context>
<context>
    <name>ViewpointEditor</name>
    <message>
        <source>Keep in the next plan</source>
        <translation>Für Neuplanung fixieren</translation>
    </message>
    <message>
        <source>Keep this viewpoint as it is when planning again</source>
        <translation>Diesen Aufnahmepunkt beim Neuplanen unverändert lassen</translation>
    </message>
    <message>
        <source>Add</source>
        <translation>Neu</translation>
    </message>
    <message>
        <source>A new viewpoint beside this one</source>
        <translation>Ein neuer Aufnahmepunkt neben diesem</translation>
    </message>
    <message>
        <source>Delete</source>
        <translation>Löschen</translation>
    </message>
    <message>
        <source>Aim at panel</source>
        <translation>Ausrichten</translation>
    </message>
    <message>
        <source>Turn towards the panel that was selected last</source>
        <translation>Zur zuletzt ausgewählten Scheibe drehen</translation>
    </message>
    <message>
        <source>East</source>
        <translation>Ost</translation>
    </message>
    <message>
        <source>North</source>
        <translation>Nord</translation>
    </message>
    <message>
        <source>Up</source>
        <translation>Höhe</translation>
    </message>
    <message>
        <source>Heading</source>
        <translation>Richtung</translation>
    </message>
    <message>
        <source>Pitch</source>
        <translation>Gimbalneigung</translation>
    </message>
    <message>
        <source>No viewpoint selected</source>
        <translation>Kein Aufnahmepunkt ausgewählt</translation>
    </message>
</context>
<context>
    <name>ViewpointPage</name>
    <message>
        <source>Move in the 3-D view</source>
        <translation>In 3D verschieben</translation>
    </message>
    <message>
        <source>Drag the selected viewpoint; with Shift along its line of sight; or arrow keys</source>
        <translation>Gewählten Aufnahmepunkt ziehen; mit Umschalt längs der Blickrichtung; oder Pfeiltasten</translation>
    </message>
    <message>
        <source>Add viewpoint</source>
        <translation>Aufnahmepunkt hinzufügen</translation>
    </message>
    <message>
        <source>Delete viewpoint</source>
        <translation>Aufnahmepunkt löschen</translation>
    </message>
    <message>
        <source>Keep viewpoint when planning again</source>
        <translation>Aufnahmepunkt für Neuplanung fixieren</translation>
    </message>
    <message>
        <source>Move viewpoint in the 3-D view</source>
        <translation>Aufnahmepunkt in der 3D-Ansicht verschieben</translation>
    </message>
    <message>
        <source>Covers {0} panels, {1} sections that no other view covers. The plan covers {2}.</source>
        <translation>Deckt {0} Scheiben ab und {1} Sektoren, die keine andere Aufnahme abdeckt. Der Plan deckt {2} ab.</translation>
    </message>
    <message>
        <source>Click a panel first, then the viewpoint, then Aim.</source>
        <translation>Erst eine Scheibe anklicken, dann den Aufnahmepunkt, dann „Ausrichten“.</translation>
    </message>
</context>
<context>
    <name>WarningBanner</name>
    <message>
        <source>Warnings</source>
        <translation>Warnungen</translation>
    </message>
    <message>
        <source>Mute</source>
        <translation>Stumm</translation>
    </message>
    <message>
        <source>Warnings are shown, and not spoken</source>
        <translation>Warnungen werden gezeigt und nicht gesprochen</translation>
    </message>
    <message>
        <source>{0} more in the list</source>
        <translation>{0} weitere in der Liste</translation>
    </message>
    <message>
        <source>DANGER</source>
        <translation>GEFAHR</translation>
    </message>
    <message>
        <source>Warning</source>
        <translation>Warnung</translation>
    </message>
    <message>
        <source>{0} ({1}): {2}</source>
        <translation>{0} ({1}): {2}</translation>
    </message>
</context>
<context>
    <name>WarningSpeaker</name>
    <message>
        <source>Danger</source>
        <translation>Gefahr</translation>
    </message>
    <message>
        <source>Warning</source>
        <translation>Warnung</translation>
    </message>
    <message>
        <source>{0}: {1}</source>
        <translation>{0}: {1}</translation>
    </message>
</context>
<context>
    <name>WarningsView</name>
    <message>
        <source>No warnings.</source>
        <translation>Keine Warnungen.</translation>
    </message>
    <message>
        <source>Danger: {0}</source>
        <translation>Gefahr: {0}</translation>
    </message>
    <message>
        <source>Warning: {0}</source>
        <translation>Warnung: {0}</translation>
    </message>
</context>
<context>
    <name>WaypointModel</name>
    <message>
        <source>The path turns here; no photo is taken.</source>
        <translation>Hier knickt der Flugweg; kein Foto.</translation>
    </message>
    <message>
        <source>none</source>
        <translation>keiner</translation>
    </message>
    <message>
        <source>locked</source>
        <translation>fixiert</translation>
    </message>
    <message>
        <source>Sortie</source>
        <translation>Einsatz</translation>
    </message>
    <message>
        <source>No.</source>
        <translation>Nr.</translation>
    </message>
    <message>
        <source>Viewpoint</source>
        <translation>Aufnahmepunkt</translation>
    </message>
    <message>
        <source>East [{0}]</source>
        <translation>Ost [{0}]</translation>
    </message>
    <message>
        <source>Latitude [°]</source>
        <translation>Breitengrad [°]</translation>
    </message>
    <message>
        <source>North [{0}]</source>
        <translation>Nord [{0}]</translation>
    </message>
    <message>
        <source>Longitude [°]</source>
        <translation>Längengrad [°]</translation>
    </message>
    <message>
        <source>Above take-off [{0}]</source>
        <translation>Über Start [{0}]</translation>
    </message>
    <message>
        <source>Heading [°]</source>
        <translation>Richtung [°]</translation>
    </message>
    <message>
        <source>Gimbal [°]</source>
        <translation>Gimbal [°]</translation>
    </message>
    <message>
        <source>Leg [{0}]</source>
        <translation>Strecke [{0}]</translation>
    </message>
    <message>
        <source>Arrival</source>
        <translation>Ankunft</translation>
    </message>
    <message>
        <source>Panels</source>
        <translation>Scheiben</translation>
    </message>
    <message>
        <source>Locked</source>
        <translation>Fixiert</translation>
    </message>
    <message>
        <source>Up, local [{0}]</source>
        <translation>Höhe, lokal [{0}]</translation>
    </message>
    <message>
        <source>Above sea (EGM96) [{0}]</source>
        <translation>Über Meer (EGM96) [{0}]</translation>
    </message>
    <message>
        <source>Above ellipsoid [{0}]</source>
        <translation>Über Ellipsoid [{0}]</translation>
    </message>
    <message>
        <source>Place on the path of its sortie: 0 is take-off, leg 5 ends at 5</source>
        <translation>Platz auf dem Flugweg des Einsatzes: 0 ist der Start, Strecke 5 endet bei 5</translation>
    </message>
    <message>
        <source>Clockwise from true north</source>
        <translation>Im Uhrzeigersinn ab geografisch Nord</translation>
    </message>
    <message>
        <source>0 level, -90 straight down</source>
        <translation>0 waagerecht, -90 senkrecht nach unten</translation>
    </message>
    <message>
        <source>Length of the leg that ends here</source>
        <translation>Länge der Strecke, die hier endet</translation>
    </message>
    <message>
        <source>Minutes and seconds after lift-off, with a stop at every waypoint</source>
        <translation>Minuten und Sekunden nach dem Abheben, mit Halt an jedem Wegpunkt</translation>
    </message>
    <message>
        <source>Panels that this photo covers; known after a check</source>
        <translation>Scheiben, die dieses Foto abdeckt; bekannt nach einer Prüfung</translation>
    </message>
</context>
<context>
    <name>WaypointTable</name>
    <message>
        <source>Photos only</source>
        <translation>Nur Fotos</translation>
    </message>
    <message>
        <source>Leave out where the path only turns</source>
        <translation>Knicke im Flugweg ohne Foto auslassen</translation>
    </message>
    <message>
        <source>All sorties</source>
        <translation>Alle Einsätze</translation>
    </message>
    <message>
        <source>Sortie {0}</source>
        <translation>Einsatz {0}</translation>
    </message>
    <message>
        <source>In no sortie</source>
        <translation>In keinem Einsatz</translation>
    </message>
    <message>
        <source>Frame of the positions; east and north count from the site&apos;s origin</source>
        <translation>Bezug der Positionen; Ost und Nord zählen vom Nullpunkt des Standorts</translation>
    </message>
    <message>
        <source>What heights are counted from; heights above take-off are always shown, too</source>
        <translation>Wovon Höhen zählen; Höhen über Start stehen immer dabei</translation>
    </message>
    <message>
        <source>East, north</source>
        <translation>Ost, Nord</translation>
    </message>
    <message>
        <source>Lat, lon (WGS 84)</source>
        <translation>Grad (WGS 84)</translation>
    </message>
    <message>
        <source>Heights: local</source>
        <translation>Höhen: lokal</translation>
    </message>
    <message>
        <source>Heights: sea level (EGM96)</source>
        <translation>Höhen: Meer (EGM96)</translation>
    </message>
    <message>
        <source>Heights: ellipsoid (WGS 84)</source>
        <translation>Höhen: Ellipsoid</translation>
    </message>
    <message>
        <source>Waypoints</source>
        <translation>Wegpunkte</translation>
    </message>
</context>
<context>
    <name>Words</name>
    <message>
        <source>“{0}”</source>
        <translation>„{0}“</translation>
    </message>
</context>
<context>
    <name>ZoneFilePage</name>
    <message>
        <source>Remove this file</source>
        <translation>Diese Datei entfernen</translation>
    </message>
    <message>
        <source>File of geo-zones</source>
        <translation>Datei mit Geozonen</translation>
    </message>
    <message>
        <source>Zones: {0}, near the site: {1}</source>
        <translation>Zonen: {0}, nahe am Standort: {1}</translation>
    </message>
    <message>
        <source>Remove {0}</source>
        <translation>{0} entfernen</translation>
    </message>
</context>
<context>
    <name>ZonePage</name>
    <message>
        <source>number and date, or who answered when</source>
        <translation>Aktenzeichen und Datum, oder wer wann geantwortet hat</translation>
    </message>
    <message>
        <source>Geo-zone</source>
        <translation>Geozone</translation>
    </message>
    <message>
        <source>Authorisation</source>
        <translation>Genehmigung</translation>
    </message>
    <message>
        <source>With an authorisation plans may enter this zone. It holds for this state of the file.</source>
        <translation>Mit einer Genehmigung dürfen Pläne in diese Zone führen. Sie gilt für diesen Stand der Datei.</translation>
    </message>
    <message>
        <source>Source</source>
        <translation>Quelle</translation>
    </message>
    <message>
        <source>{0} from the airspace</source>
        <translation>{0} vom Luftraum</translation>
    </message>
    <message>
        <source>Its place is not known.</source>
        <translation>Ihr Ort ist nicht bekannt.</translation>
    </message>
    <message>
        <source>It reaches over the airspace.</source>
        <translation>Sie reicht über den Luftraum.</translation>
    </message>
    <message>
        <source>Authorisation for {0}</source>
        <translation>Genehmigung für {0}</translation>
    </message>
</context>
<context>
    <name>ZonesForm</name>
    <message>
        <source>Authorisation</source>
        <translation>Genehmigung</translation>
    </message>
</context>
<context>
    <name>_EffectCard</name>
    <message>
        <source>auto</source>
        <translation>auto</translation>
    </message>
    <message>
        <source>on</source>
        <translation>an</translation>
    </message>
    <message>
        <source>off</source>
        <translation>aus</translation>
    </message>
    <message>
        <source>is on</source>
        <translation>ist an</translation>
    </message>
    <message>
        <source>is off</source>
        <translation>ist aus</translation>
    </message>
    <message>
        <source> (as you asked)</source>
        <translation> (wie verlangt)</translation>
    </message>
    <message>
        <source>Size {0:.3g} {1}, tolerance {2:.3g}; costs about {3:.1f} s</source>
        <translation>Größe {0:.3g} {1}, Toleranz {2:.3g}; kostet etwa {3:.1f} s</translation>
    </message>
</context>
</TS>
